import { Button, Group, Stack } from "@mantine/core";
import { KeyRound } from "lucide-react";
import { useEffect, useRef } from "react";
import { Link } from "wouter";
import type { RegisteredDevice } from "../../api/types";
import { Copyable } from "../../components/Copyable";
import { QrCode } from "../../components/QrCode";
import { Notice } from "../../components/Tone";
import { t } from "../../text";
import { uploadCommand } from "../upload";
import css from "./added.module.css";

interface AddedProps {
  registered: RegisteredDevice;
  onDone: () => void;
}

/** The key is not kept in readable form anywhere: whoever adds the device carries it there now. */
export function Added({ registered: { device, key }, onDone }: AddedProps) {
  const top = useRef<HTMLDivElement>(null);
  // Not on a button: a second press of Enter would close the dialog, and the key would be lost.
  useEffect(() => top.current?.focus({ preventScroll: true }), []);
  return (
    <Stack ref={top} tabIndex={-1} className={css.top}>
      <Notice tone="warn" icon={KeyRound} title={t("devices.done.once")}>
        <p>{t("devices.done.once_about")}</p>
      </Notice>
      <Copyable label={t("devices.done.key", { name: device.name })} text={key} />
      <div className={css.qr}>
        <QrCode text={key} label={t("devices.done.qr", { name: device.name })} size={144} />
        <p>{t("devices.done.qr_about")}</p>
      </div>
      <Copyable label={t("devices.done.command")} text={uploadCommand(device.id, key, location.origin)} />
      <Group justify="flex-end">
        <Button variant="default" onClick={onDone}>
          {t("common.done")}
        </Button>
        <Button component={Link} href={`/devices/${encodeURIComponent(device.id)}`}>
          {t("devices.done.open")}
        </Button>
      </Group>
    </Stack>
  );
}
