import { Button, Checkbox } from "@mantine/core";
import { useId, useState } from "react";
import type { Verb } from "../api/alerts";
import type { Alert } from "../api/types";
import { ClockTime, RelativeTime } from "../components/RelativeTime";
import { Pill } from "../components/Tone";
import { beginning } from "../device/evidence";
import { whole } from "../lib/format";
import { language, Trans, t } from "../text";
import { AlertDetails } from "./AlertDetails";
import css from "./alerts.module.css";
import { DeviceLink } from "./DeviceLink";
import { SEVERITY, STATE } from "./look";
import { SettleDialog } from "./SettleDialog";
import { isDue } from "./settling";
import { finding } from "./words";

interface AlertCardProps {
  alert: Alert;
  /** false where the whole page is about the device */
  showDevice: boolean;
  unfolded?: boolean;
  selection?: { selected: boolean; onChange: (selected: boolean) => void };
}

/** An alert: what was found on which device, how bad it is, who is on it, and what can be done. */
export function AlertCard({ alert, showDevice, unfolded = false, selection }: AlertCardProps) {
  const [title, check] = [useId(), useId()];
  const Title = showDevice ? "h2" : "h3";
  const { tone } = alert.state === "resolved" ? STATE.resolved : SEVERITY[alert.severity];
  return (
    <article className={css.card} data-tone={tone} aria-labelledby={title}>
      <div className={css.body}>
        {selection && isDue(alert, "resolve") && (
          <label className={css.check} htmlFor={check}>
            <Checkbox
              id={check}
              aria-label={t("alerts.card.select", { what: `${finding(alert)}, ${alert.device_id}` })}
              checked={selection.selected}
              onChange={(event) => selection.onChange(event.currentTarget.checked)}
            />
          </label>
        )}
        <div>
          <Title id={title}>{finding(alert)}</Title>
          <p className={css.facts}>
            {showDevice && <DeviceLink id={alert.device_id} />}
            <Times alert={alert} />
          </p>
          {language() === "en" && <p className={css.message}>{alert.message}</p>}
        </div>
      </div>
      <div className={css.side}>
        <Pills alert={alert} />
        <Actions alert={alert} />
      </div>
      <AlertDetails alert={alert} showDevice={showDevice} unfolded={unfolded} />
    </article>
  );
}

function Times({ alert }: { alert: Alert }) {
  const when = (at: string) => ({ when: <RelativeTime at={at} /> });
  const since = beginning(alert.data);
  return (
    <>
      <span>
        <Trans i18nKey="alerts.card.opened" components={when(alert.opened_at)} />
      </span>
      {alert.updated_at !== alert.opened_at && (
        <span>
          <Trans i18nKey="alerts.card.updated" components={when(alert.updated_at)} />
        </span>
      )}
      {since && alert.kind !== "device_silent" && (
        <span>
          <Trans i18nKey="alerts.card.began" components={{ when: <ClockTime at={since} /> }} />
        </span>
      )}
      {alert.count > 1 && <span>{t("alerts.card.count", { number: whole(alert.count) })}</span>}
    </>
  );
}

function Pills({ alert: { severity, state } }: { alert: Alert }) {
  return (
    <div className={css.pills}>
      <Pill tone={SEVERITY[severity].tone} icon={SEVERITY[severity].icon}>
        {t(`alerts.severity.${severity}`)}
      </Pill>
      <Pill tone={STATE[state].tone} icon={STATE[state].icon}>
        {t(`alerts.state.${state}`)}
      </Pill>
    </div>
  );
}

const VERBS = ["acknowledge", "resolve"] as const satisfies readonly Verb[];

function Actions({ alert }: { alert: Alert }) {
  const [verb, setVerb] = useState<Verb | null>(null);
  const due = VERBS.filter((name) => isDue(alert, name));
  return (
    <>
      {due.length > 0 && (
        <div className={`${css.actions} no-print`}>
          {due.map((name) => (
            <Button key={name} variant="default" onClick={() => setVerb(name)}>
              {t(`alerts.card.${name}`)}
            </Button>
          ))}
        </div>
      )}
      {verb && <SettleDialog alerts={[alert]} verb={verb} onClose={() => setVerb(null)} />}
    </>
  );
}
