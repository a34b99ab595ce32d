import { Button } from "@mantine/core";
import { CircleCheck, CircleX, Send } from "lucide-react";
import type { ReactNode } from "react";
import type { WebhookTest as Result } from "../api/types";
import { useTestWebhook } from "../api/webhooks";
import { Trouble } from "../components/States";
import { Notice } from "../components/Tone";
import { whole } from "../lib/format";
import { t } from "../text";
import css from "./settings.module.css";

/** Call a webhook now, and say how that went; `children`: what else can be done with it. */
export function WebhookTest({ id, children }: { id: number; children: ReactNode }) {
  const test = useTestWebhook(id);
  return (
    <>
      <div className={css.actions}>
        <Button
          variant="light"
          leftSection={<Send size={18} aria-hidden />}
          loading={test.isPending}
          onClick={() => test.mutate()}
        >
          {t("settings.webhooks.test")}
        </Button>
        {children}
      </div>
      <div role="status">{test.data && !test.isPending && <Outcome result={test.data} />}</div>
      {test.error && (
        <Trouble
          title={t("settings.webhooks.could_not_test")}
          error={test.error}
          retry={() => test.mutate()}
        />
      )}
    </>
  );
}

function Outcome({ result: { delivered, status, error, duration_ms } }: { result: Result }) {
  return (
    <Notice
      tone={delivered ? "good" : "bad"}
      icon={delivered ? CircleCheck : CircleX}
      title={t(delivered ? "settings.webhooks.test_ok" : "settings.webhooks.test_bad")}
    >
      <p>
        {t("settings.webhooks.test_result", {
          status: status ?? t("settings.webhooks.no_answer"),
          duration: whole(duration_ms),
        })}
      </p>
      {error && <p lang="en">{error}</p>}
    </Notice>
  );
}
