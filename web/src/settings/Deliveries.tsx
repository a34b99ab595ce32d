import { Button } from "@mantine/core";
import { CircleCheck, CircleX, Hourglass, RotateCw } from "lucide-react";
import { useState } from "react";
import type { WebhookDelivery } from "../api/types";
import { useDeliveries, useRedeliver } from "../api/webhooks";
import { RelativeTime } from "../components/RelativeTime";
import { say } from "../components/Said";
import { Failed, Loading, Trouble } from "../components/States";
import { Pill } from "../components/Tone";
import { whole } from "../lib/format";
import { Trans, t } from "../text";
import { More } from "./More";
import css from "./settings.module.css";

/** What was sent to a webhook, and what became of it: read when it is unfolded. */
export function Deliveries({ id }: { id: number }) {
  const [open, setOpen] = useState(false);
  return (
    <details className={css.details} onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>{t("settings.deliveries.title")}</summary>
      {open && <Log id={id} />}
    </details>
  );
}

function Log({ id }: { id: number }) {
  const list = useDeliveries(id);
  if (list.isPending) return <Loading what={t("settings.deliveries.the_deliveries")} />;
  if (list.isError)
    return <Failed what={t("settings.deliveries.the_deliveries")} error={list.error} retry={list.refetch} />;
  if (list.data.length === 0) return <p className={css.quiet}>{t("settings.deliveries.none")}</p>;
  return (
    <>
      {list.data.some(isRepeatable) && <Again id={id} />}
      <ul className={css.list} aria-label={t("settings.deliveries.title")}>
        {list.data.map((delivery) => (
          <li key={delivery.id} className={css.row}>
            <Delivery delivery={delivery} />
          </li>
        ))}
      </ul>
      <More list={list} />
    </>
  );
}

/** A test that failed is over; what was to be told of a device is not. */
function isRepeatable({ state, type }: WebhookDelivery): boolean {
  return state === "failed" && type !== "test";
}

const LOOK = {
  pending: { tone: "accent", icon: Hourglass },
  delivered: { tone: "good", icon: CircleCheck },
  failed: { tone: "bad", icon: CircleX },
} as const;

function Delivery({ delivery }: { delivery: WebhookDelivery }) {
  const { state, type, device_id, created_at, last_error } = delivery;
  return (
    <div>
      <p className={css.title}>
        <strong>{typeWord(type)}</strong>
        {device_id && <span>{device_id}</span>}
        <Pill tone={LOOK[state].tone} icon={LOOK[state].icon}>
          {t(`settings.deliveries.state.${state}`)}
        </Pill>
      </p>
      <p className={css.facts}>
        <RelativeTime at={created_at} />
        <Attempts delivery={delivery} />
      </p>
      {last_error && (
        <p className={css.facts} lang="en">
          {last_error}
        </p>
      )}
    </div>
  );
}

function typeWord(type: WebhookDelivery["type"]): string {
  return t(`settings.deliveries.type.${type}`);
}

function Attempts({ delivery }: { delivery: WebhookDelivery }) {
  const { attempts, last_status, duration_ms, last_attempt_at, next_attempt_at, state } = delivery;
  const when = (at: string) => ({ when: <RelativeTime at={at} /> });
  return (
    <>
      <span>{t("settings.deliveries.attempts", { count: attempts, number: whole(attempts) })}</span>
      {last_status !== null && <span>{t("settings.deliveries.answer", { status: last_status })}</span>}
      {duration_ms !== null && <span>{t("settings.deliveries.took", { duration: whole(duration_ms) })}</span>}
      {last_attempt_at && (
        <span>
          <Trans i18nKey="settings.deliveries.last" components={when(last_attempt_at)} />
        </span>
      )}
      {state === "pending" && next_attempt_at && (
        <span>
          <Trans i18nKey="settings.deliveries.next" components={when(next_attempt_at)} />
        </span>
      )}
    </>
  );
}

/** Try what was given up once more. */
function Again({ id }: { id: number }) {
  const again = useRedeliver(id);
  const run = () => again.mutate(undefined, { onSuccess: ({ deliveries }) => say(againText(deliveries)) });
  return (
    <>
      <Button
        variant="default"
        leftSection={<RotateCw size={18} aria-hidden />}
        loading={again.isPending}
        onClick={run}
      >
        {t("settings.deliveries.again")}
      </Button>
      {again.error && (
        <Trouble title={t("settings.deliveries.could_not_again")} error={again.error} retry={run} />
      )}
    </>
  );
}

function againText(count: number): string {
  if (count === 0) return t("settings.deliveries.again_none");
  return t("settings.deliveries.again_done", { count, number: whole(count) });
}
