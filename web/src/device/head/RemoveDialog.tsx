import { TextInput } from "@mantine/core";
import { useState } from "react";
import { useLocation } from "wouter";
import { useRemoveDevice } from "../../api/device";
import type { Device } from "../../api/types";
import { Asking } from "../../components/Asking";
import { Trouble } from "../../components/States";
import { t } from "../../text";

/** Whoever removes a device types its name: the finger that slips does not. */
export default function RemoveDialog({ device, onClose }: { device: Device; onClose: () => void }) {
  const remove = useRemoveDevice(device.id);
  const [typed, setTyped] = useState("");
  const [, go] = useLocation();
  return (
    <Asking
      opened
      onClose={onClose}
      title={t("device.removal.title")}
      go={t("device.removal.go")}
      onGo={() => remove.mutate(undefined, { onSuccess: () => go("/devices", { replace: true }) })}
      pending={remove.isPending}
      disabled={typed.trim() !== device.name}
      grave
    >
      <p>{t("device.removal.about")}</p>
      <TextInput
        label={t("device.removal.type", { name: device.name })}
        value={typed}
        onChange={(event) => setTyped(event.currentTarget.value)}
        autoCapitalize="off"
        autoComplete="off"
        spellCheck={false}
        data-autofocus
      />
      {remove.error && <Trouble title={t("device.removal.failed")} error={remove.error} />}
    </Asking>
  );
}
