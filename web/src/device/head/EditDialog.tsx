import { Textarea, TextInput } from "@mantine/core";
import { useState } from "react";
import { useEditDevice } from "../../api/device";
import { Problem } from "../../api/http";
import type { Device, DevicePatch } from "../../api/types";
import { Asking } from "../../components/Asking";
import { Trouble } from "../../components/States";
import { t } from "../../text";

export default function EditDialog({ device, onClose }: { device: Device; onClose: () => void }) {
  const edit = useEditDevice(device.id);
  const { name, vehicle, notes } = device;
  const [fields, setFields] = useState({ name, vehicle: vehicle ?? "", notes: notes ?? "" });
  const wrong = edit.error instanceof Problem ? edit.error.fields : {};
  const input = (field: keyof typeof fields) => ({
    value: fields[field],
    onChange: (event: { currentTarget: { value: string } }) =>
      setFields({ ...fields, [field]: event.currentTarget.value }),
    error: wrong[field],
  });
  return (
    <Asking
      opened
      onClose={onClose}
      title={t("device.edit.title")}
      go={t("device.edit.save")}
      onGo={() => edit.mutate(patch(fields), { onSuccess: onClose })}
      pending={edit.isPending}
      disabled={fields.name.trim() === ""}
    >
      <TextInput label={t("device.edit.name")} maxLength={128} required data-autofocus {...input("name")} />
      <TextInput
        label={t("device.edit.vehicle")}
        placeholder={t("device.edit.vehicle_example")}
        maxLength={128}
        {...input("vehicle")}
      />
      <Textarea
        label={t("device.edit.notes")}
        autosize
        minRows={2}
        maxRows={8}
        maxLength={4000}
        {...input("notes")}
      />
      {edit.error && Object.keys(wrong).length === 0 && (
        <Trouble title={t("device.edit.failed")} error={edit.error} />
      )}
    </Asking>
  );
}

/** What was emptied is cleared. */
function patch({ name, vehicle, notes }: Record<"name" | "vehicle" | "notes", string>): DevicePatch {
  return { name: name.trim(), vehicle: vehicle.trim() || null, notes: notes.trim() || null };
}
