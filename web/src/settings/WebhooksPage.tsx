import { Button } from "@mantine/core";
import { Plus, Webhook as WebhookIcon } from "lucide-react";
import { useState } from "react";
import { useWebhooks } from "../api/webhooks";
import { Empty, Failed, Loading } from "../components/States";
import { t } from "../text";
import { More } from "./More";
import css from "./settings.module.css";
import { WebhookCard } from "./WebhookCard";
import { WebhookDialog } from "./WebhookDialog";

/** Who is called when an alert changes. */
export function WebhooksPage() {
  const [adding, setAdding] = useState(false);
  return (
    <>
      <div className={css.head}>
        <p>{t("settings.webhooks.about")}</p>
        <Button leftSection={<Plus size={20} aria-hidden />} onClick={() => setAdding(true)}>
          {t("settings.webhooks.add")}
        </Button>
      </div>
      <Webhooks />
      {adding && <WebhookDialog webhook={null} onClose={() => setAdding(false)} />}
    </>
  );
}

function Webhooks() {
  const list = useWebhooks();
  if (list.isPending) return <Loading what={t("settings.webhooks.the_webhooks")} lines={4} />;
  if (list.isError)
    return <Failed what={t("settings.webhooks.the_webhooks")} error={list.error} retry={list.refetch} />;
  if (list.data.length === 0) return <None />;
  return (
    <>
      <ul className={css.cards} aria-label={t("settings.webhooks.list")}>
        {list.data.map((webhook) => (
          <li key={webhook.id}>
            <WebhookCard webhook={webhook} />
          </li>
        ))}
      </ul>
      <More list={list} />
    </>
  );
}

function None() {
  return (
    <div className="card">
      <Empty icon={WebhookIcon} title={t("settings.webhooks.none")}>
        <p>{t("settings.webhooks.none_about")}</p>
      </Empty>
    </div>
  );
}
