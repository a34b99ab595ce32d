import { Button, Group, Modal, Stack } from "@mantine/core";
import { KeyRound } from "lucide-react";
import { useNewKey } from "../../api/device";
import type { Device } from "../../api/types";
import { Asking } from "../../components/Asking";
import { Copyable } from "../../components/Copyable";
import { QrCode } from "../../components/QrCode";
import { Trouble } from "../../components/States";
import { Notice } from "../../components/Tone";
import { t } from "../../text";
import css from "./head.module.css";

/** Asks first, because the present key ends; then the new one is shown this once. */
export default function KeyDialog({ device, onClose }: { device: Device; onClose: () => void }) {
  const made = useNewKey(device.id);
  if (made.data) return <NewKey name={device.name} text={made.data.key} onClose={onClose} />;
  return (
    <Asking
      opened
      onClose={onClose}
      title={t("device.key.ask")}
      go={t("device.key.go")}
      onGo={() => made.mutate()}
      pending={made.isPending}
    >
      <p>{t("device.key.about")}</p>
      {made.error && <Trouble title={t("device.key.failed")} error={made.error} />}
    </Asking>
  );
}

function NewKey({ name, text, onClose }: { name: string; text: string; onClose: () => void }) {
  return (
    <Modal
      opened
      onClose={onClose}
      title={t("device.key.made")}
      closeOnClickOutside={false}
      closeOnEscape={false}
      closeButtonProps={{ "aria-label": t("common.close") }}
    >
      <Stack>
        <Notice tone="warn" icon={KeyRound} title={t("device.key.once")}>
          <p>{t("device.key.once_do")}</p>
        </Notice>
        <Copyable label={t("device.key.label", { name })} text={text} />
        <div className={css.code}>
          <QrCode text={text} label={t("device.key.code")} size={208} />
        </div>
        <Group justify="flex-end">
          <Button onClick={onClose}>{t("common.done")}</Button>
        </Group>
      </Stack>
    </Modal>
  );
}
