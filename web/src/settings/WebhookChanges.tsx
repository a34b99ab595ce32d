import type { Webhook } from "../api/types";
import { useRemoveWebhook, useRotateSecret } from "../api/webhooks";
import { Dialog } from "../components/Dialog";
import { say } from "../components/Said";
import { Trouble } from "../components/States";
import { t } from "../text";
import { ConfirmDialog } from "./ConfirmDialog";
import { Once } from "./Once";

interface ChangeProps {
  webhook: Webhook;
  onClose: () => void;
}

export function RemoveDialog({ webhook: { id, name }, onClose }: ChangeProps) {
  const remove = useRemoveWebhook(id);
  const done = () => {
    say(t("settings.webhooks.removed", { name }));
    onClose();
  };
  return (
    <ConfirmDialog
      title={t("settings.webhooks.remove_title", { name })}
      about={t("settings.webhooks.remove_about")}
      action={t("settings.webhooks.remove")}
      pending={remove.isPending}
      onConfirm={() => remove.mutate(undefined, { onSuccess: done })}
      onClose={onClose}
    >
      {remove.error && <Trouble title={t("settings.webhooks.could_not_remove")} error={remove.error} />}
    </ConfirmDialog>
  );
}

export function RotateDialog({ webhook: { id, name }, onClose }: ChangeProps) {
  const rotate = useRotateSecret(id);
  if (rotate.data) return <SecretDialog name={name} secret={rotate.data.secret} onClose={onClose} />;
  return (
    <ConfirmDialog
      title={t("settings.webhooks.rotate_title", { name })}
      about={t("settings.webhooks.rotate_about")}
      action={t("settings.webhooks.rotate")}
      pending={rotate.isPending}
      onConfirm={() => rotate.mutate()}
      onClose={onClose}
    >
      {rotate.error && <Trouble title={t("settings.webhooks.could_not_rotate")} error={rotate.error} />}
    </ConfirmDialog>
  );
}

interface SecretProps {
  name: string;
  secret: string;
  onClose: () => void;
}

/** The secret of a webhook, shown this once. */
export function SecretDialog({ name, secret, onClose }: SecretProps) {
  return (
    <Dialog onClose={onClose} title={t("settings.webhooks.secret_title", { name })} stays>
      <Once
        title={t("settings.webhooks.secret_once")}
        about={t("settings.webhooks.secret_about")}
        label={t("settings.webhooks.secret")}
        secret={secret}
        onDone={onClose}
      />
    </Dialog>
  );
}
