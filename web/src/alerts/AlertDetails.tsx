import { Anchor } from "@mantine/core";
import { lazy, Suspense, useState } from "react";
import { Link } from "wouter";
import type { Alert } from "../api/types";
import { ClockTime } from "../components/RelativeTime";
import { language, Trans, t } from "../text";
import css from "./alerts.module.css";
import { SERVICE } from "./settling";
import { meaning, remedy } from "./words";

/** The charts come only when somebody wants to know why. */
const Evidence = lazy(() => import("../device/Evidence").then((m) => ({ default: m.Evidence })));

interface AlertDetailsProps {
  alert: Alert;
  showDevice: boolean;
  unfolded: boolean;
}

/** What it means and calls for, what it was decided on, and who did what about it. */
export function AlertDetails({ alert, showDevice, unfolded }: AlertDetailsProps) {
  const [open, setOpen] = useState(unfolded);
  return (
    <details className={css.details} open={open} onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>{t("alerts.card.more")}</summary>
      {open && (
        <>
          <Words alert={alert} />
          <History alert={alert} />
          <Suspense fallback={null}>
            <Evidence kind={alert.kind} data={alert.data} unfolded />
          </Suspense>
          <ToEvents alert={alert} />
          {showDevice && <Links alert={alert} />}
        </>
      )}
    </details>
  );
}

function Words({ alert }: { alert: Alert }) {
  return (
    <dl className={css.words}>
      <dt>{t("alerts.card.means")}</dt>
      <dd>{meaning(alert)}</dd>
      <dt>{t("alerts.card.do")}</dt>
      <dd>{remedy(alert)}</dd>
      {language() !== "en" && (
        <>
          <dt>{t("alerts.card.message")}</dt>
          <dd lang="en">{alert.message}</dd>
        </>
      )}
    </dl>
  );
}

/** Who acknowledged and resolved it, when, and with which note; the service's own notes are English. */
function History({ alert }: { alert: Alert }) {
  const { acknowledged_at, acknowledged_by, acknowledge_note } = alert;
  const { resolved_at, resolved_by, resolve_note } = alert;
  if (!acknowledged_at && !resolved_at) return null;
  const byService = resolved_by === SERVICE;
  return (
    <ul className={css.history} aria-label={t("alerts.card.history")}>
      {acknowledged_at && (
        <li>
          <Trans
            i18nKey="alerts.card.acknowledged"
            components={{ who: <b>{acknowledged_by}</b>, when: <ClockTime at={acknowledged_at} /> }}
          />
          <Note text={acknowledge_note} />
        </li>
      )}
      {resolved_at && (
        <li>
          <Trans
            i18nKey={byService ? "alerts.card.resolved_service" : "alerts.card.resolved"}
            components={{ who: <b>{resolved_by}</b>, when: <ClockTime at={resolved_at} /> }}
          />
          <Note text={resolve_note} lang={byService ? "en" : undefined} />
        </li>
      )}
    </ul>
  );
}

function Note({ text, lang }: { text: string | null; lang?: string | undefined }) {
  return text ? <blockquote lang={lang}>{text}</blockquote> : null;
}

/** What happened to the vehicle is told on a page of its own. */
function ToEvents({ alert: { kind, data, device_id } }: { alert: Alert }) {
  if (kind !== "impact" && kind !== "harsh_driving") return null;
  const motion = `/devices/${encodeURIComponent(device_id)}/motion`;
  const event = typeof data.event === "number" ? data.event : null;
  return (
    <p className={css.links}>
      <Anchor component={Link} href={event === null ? motion : `${motion}/${event}`}>
        {t(event === null ? "alerts.card.events" : "alerts.card.event")}
      </Anchor>
    </p>
  );
}

function Links({ alert: { id, device_id } }: { alert: Alert }) {
  return (
    <p className={css.links}>
      <Anchor component={Link} href={`/alerts?id=${id}`}>
        {t("alerts.card.link")}
      </Anchor>
      <Anchor component={Link} href={`/alerts?device=${encodeURIComponent(device_id)}&state=all`}>
        {t("alerts.card.only_device")}
      </Anchor>
    </p>
  );
}
