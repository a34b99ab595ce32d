import { Button } from "@mantine/core";
import { CircleCheck, CircleDashed, CircleX, PowerOff } from "lucide-react";
import { useId, useState } from "react";
import type { Webhook } from "../api/types";
import { RelativeTime } from "../components/RelativeTime";
import { Pill } from "../components/Tone";
import { listed } from "../lib/format";
import { Trans, t } from "../text";
import { Deliveries } from "./Deliveries";
import css from "./settings.module.css";
import { RemoveDialog, RotateDialog } from "./WebhookChanges";
import { WebhookDialog } from "./WebhookDialog";
import { WebhookTest } from "./WebhookTest";

const DIALOGS = { edit: WebhookDialog, rotate: RotateDialog, remove: RemoveDialog } as const;

/** A webhook: whom it calls for what, how that goes, and what can be done with it. */
export function WebhookCard({ webhook }: { webhook: Webhook }) {
  const title = useId();
  const [open, setOpen] = useState<keyof typeof DIALOGS | null>(null);
  const Dialog = open && DIALOGS[open];
  return (
    <article className="card" aria-labelledby={title}>
      <div className={css.title}>
        <h3 id={title}>{webhook.name}</h3>
        <State webhook={webhook} />
      </div>
      <p className={css.url}>{webhook.url}</p>
      <p className={css.facts}>
        <span>{kinds(webhook)}</span>
        <span>{severities(webhook)}</span>
        <Times webhook={webhook} />
      </p>
      <WebhookTest id={webhook.id}>
        {(["edit", "rotate", "remove"] as const).map((name) => (
          <Button key={name} variant="default" onClick={() => setOpen(name)}>
            {t(`settings.webhooks.${name}`)}
          </Button>
        ))}
      </WebhookTest>
      <Deliveries id={webhook.id} />
      {Dialog && <Dialog webhook={webhook} onClose={() => setOpen(null)} />}
    </article>
  );
}

function kinds({ kinds: chosen }: Webhook): string {
  return chosen ? listed(chosen.map((kind) => t(`alerts.kind.${kind}`))) : t("settings.webhooks.all_kinds");
}

function severities({ severities: chosen }: Webhook): string {
  return chosen
    ? listed(chosen.map((severity) => t(`alerts.severity.${severity}`)))
    : t("settings.webhooks.all_severities");
}

const LOOK = {
  off: { tone: "neutral", icon: PowerOff },
  failing: { tone: "bad", icon: CircleX },
  well: { tone: "good", icon: CircleCheck },
  fresh: { tone: "neutral", icon: CircleDashed },
} as const;

function State({ webhook }: { webhook: Webhook }) {
  const state = stateOf(webhook);
  return (
    <Pill tone={LOOK[state].tone} icon={LOOK[state].icon}>
      {t(`settings.webhooks.${state}`)}
    </Pill>
  );
}

function stateOf({ active, failing_since, last_success_at }: Webhook): keyof typeof LOOK {
  if (!active) return "off";
  if (failing_since) return "failing";
  return last_success_at ? "well" : "fresh";
}

function Times({ webhook }: { webhook: Webhook }) {
  const { failing_since, last_success_at, created_at, created_by } = webhook;
  const when = (at: string) => ({ when: <RelativeTime at={at} />, who: <b>{created_by}</b> });
  return (
    <>
      {failing_since && (
        <span>
          <Trans i18nKey="settings.webhooks.failing_since" components={when(failing_since)} />
        </span>
      )}
      {last_success_at && (
        <span>
          <Trans i18nKey="settings.webhooks.last_success" components={when(last_success_at)} />
        </span>
      )}
      <span>
        <Trans
          i18nKey={created_by ? "settings.webhooks.created_by" : "settings.webhooks.created"}
          components={when(created_at)}
        />
      </span>
    </>
  );
}
