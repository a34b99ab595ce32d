import { Button, Group, Stack, Switch, TextInput } from "@mantine/core";
import { type FormEvent, useState } from "react";
import { KINDS, SEVERITIES } from "../alerts/filters";
import { Problem } from "../api/http";
import type { Webhook, WebhookDraft } from "../api/types";
import { useSaveWebhook } from "../api/webhooks";
import { Dialog } from "../components/Dialog";
import { say } from "../components/Said";
import { Trouble } from "../components/States";
import { t } from "../text";
import { Choice } from "./Choice";
import { SecretDialog } from "./WebhookChanges";

interface WebhookDialogProps {
  /** null: a new one */
  webhook: Webhook | null;
  onClose: () => void;
}

const NEW: WebhookDraft = { name: "", url: "", kinds: null, severities: null, active: true };

/** Make or edit a webhook; the secret of a new one is shown afterwards, this once. */
export function WebhookDialog({ webhook, onClose }: WebhookDialogProps) {
  const save = useSaveWebhook(webhook?.id ?? null);
  const [draft, setDraft] = useState<WebhookDraft>(webhook ? editable(webhook) : NEW);
  const saved = save.data;
  if (saved?.secret) {
    return <SecretDialog name={saved.webhook.name} secret={saved.secret} onClose={onClose} />;
  }
  const submit = (event: FormEvent) => {
    event.preventDefault();
    save.mutate(tidied(draft), {
      onSuccess: ({ webhook: { name }, secret }) => {
        say(t("settings.webhooks.saved", { name }));
        if (secret === null) onClose();
      },
    });
  };
  return (
    <Dialog
      onClose={onClose}
      title={t(webhook ? "settings.webhooks.edit_title" : "settings.webhooks.add_title")}
    >
      <form onSubmit={submit}>
        <Stack>
          <Fields draft={draft} onChange={setDraft} error={save.error} />
          {save.error && <Trouble title={t("settings.webhooks.could_not_save")} error={save.error} />}
          <Group justify="flex-end" mt="xs">
            <Button variant="default" onClick={onClose}>
              {t("common.cancel")}
            </Button>
            <Button type="submit" loading={save.isPending}>
              {t("settings.webhooks.save")}
            </Button>
          </Group>
        </Stack>
      </form>
    </Dialog>
  );
}

function editable({ name, url, kinds, severities, active }: Webhook): WebhookDraft {
  return { name, url, kinds, severities, active };
}

/** Nothing chosen is everything. */
function tidied({ kinds, severities, ...draft }: WebhookDraft): WebhookDraft {
  return {
    ...draft,
    url: draft.url.trim(),
    kinds: kinds?.length ? kinds : null,
    severities: severities?.length ? severities : null,
  };
}

interface FieldsProps {
  draft: WebhookDraft;
  onChange: (draft: WebhookDraft) => void;
  error: Error | null;
}

function Fields({ draft, onChange, error }: FieldsProps) {
  const wrong = error instanceof Problem ? error.fields : {};
  return (
    <>
      <TextInput
        label={t("settings.webhooks.name")}
        maxLength={128}
        required
        data-autofocus
        error={wrong.name}
        value={draft.name}
        onChange={(event) => onChange({ ...draft, name: event.currentTarget.value })}
      />
      <TextInput
        type="url"
        label={t("settings.webhooks.url")}
        description={t("settings.webhooks.url_about")}
        placeholder="https://"
        maxLength={2048}
        required
        error={wrong.url}
        value={draft.url}
        onChange={(event) => onChange({ ...draft, url: event.currentTarget.value })}
      />
      <Choice
        label={t("settings.webhooks.kinds")}
        all={t("settings.webhooks.all_kinds")}
        of={KINDS.map((value) => ({ value, label: t(`alerts.kind.${value}`) }))}
        chosen={draft.kinds ?? null}
        onChange={(kinds) => onChange({ ...draft, kinds })}
      />
      <Choice
        label={t("settings.webhooks.severities")}
        all={t("settings.webhooks.all_severities")}
        of={SEVERITIES.map((value) => ({ value, label: t(`alerts.severity.${value}`) }))}
        chosen={draft.severities ?? null}
        onChange={(severities) => onChange({ ...draft, severities })}
      />
      <Switch
        size="md"
        label={t("settings.webhooks.active")}
        description={t("settings.webhooks.active_about")}
        checked={draft.active ?? true}
        onChange={(event) => onChange({ ...draft, active: event.currentTarget.checked })}
      />
    </>
  );
}
