import { Button, Group, NativeSelect, Stack, TextInput } from "@mantine/core";
import { type FormEvent, useState } from "react";
import { useMakeKey } from "../api/accessKeys";
import { Problem } from "../api/http";
import type { CreatedKey, KeyDraft, Role } from "../api/types";
import { DeviceInput } from "../components/DeviceInput";
import { Dialog } from "../components/Dialog";
import { QrCode } from "../components/QrCode";
import { Trouble } from "../components/States";
import { t } from "../text";
import { Once } from "./Once";
import css from "./settings.module.css";

const ROLES = ["installer", "manager", "admin", "device"] as const satisfies readonly Role[];

interface Fields {
  role: Role;
  name: string;
  device: string;
  lastDay: string;
}

const EMPTY: Fields = { role: "installer", name: "", device: "", lastDay: "" };

/** Two steps: what the key is for, then the key, which is shown this once. */
export function KeyDialog({ onClose }: { onClose: () => void }) {
  const make = useMakeKey();
  const [fields, setFields] = useState(EMPTY);
  const made = make.data;
  return (
    <Dialog
      onClose={onClose}
      title={t(made ? "settings.keys.made" : "settings.keys.make")}
      stays={made !== undefined}
    >
      {made ? (
        <Made made={made} onDone={onClose} />
      ) : (
        <Form
          fields={fields}
          onChange={setFields}
          onSubmit={() => make.mutate(draft(fields))}
          onCancel={onClose}
          pending={make.isPending}
          error={make.error}
        />
      )}
    </Dialog>
  );
}

function Made({ made: { name, key }, onDone }: { made: CreatedKey; onDone: () => void }) {
  return (
    <Once
      title={t("settings.keys.once")}
      about={t("settings.keys.once_about")}
      label={t("settings.keys.key_of", { name })}
      secret={key}
      onDone={onDone}
    >
      <div className={css.code}>
        <QrCode text={key} label={t("settings.keys.code", { name })} />
      </div>
    </Once>
  );
}

/** A key holds to the end of its last day, on the clock of whoever makes it. */
export function draft({ role, name, device, lastDay }: Fields): KeyDraft {
  const [year = 0, month = 1, day = 1] = lastDay.split("-").map(Number);
  return {
    role,
    name: name.trim(),
    device_id: role === "device" ? device.trim() : null,
    expires_at: lastDay === "" ? null : new Date(year, month - 1, day + 1).toISOString(),
  };
}

interface FormProps {
  fields: Fields;
  onChange: (fields: Fields) => void;
  onSubmit: () => void;
  onCancel: () => void;
  pending: boolean;
  error: Error | null;
}

function Form({ fields, onChange, onSubmit, onCancel, pending, error }: FormProps) {
  const wrong = error instanceof Problem ? error.fields : {};
  const input = (name: keyof Fields) => ({
    value: fields[name],
    onChange: (event: { currentTarget: { value: string } }) =>
      onChange({ ...fields, [name]: event.currentTarget.value }),
  });
  const submit = (event: FormEvent) => {
    event.preventDefault();
    onSubmit();
  };
  return (
    <form onSubmit={submit}>
      <Stack>
        <NativeSelect
          size="md"
          label={t("settings.keys.role")}
          description={t(`settings.keys.role_about.${fields.role}`)}
          data={ROLES.map((value) => ({ value, label: t(`shell.role.${value}`) }))}
          {...input("role")}
        />
        <TextInput
          label={t("settings.keys.name")}
          description={t("settings.keys.name_about")}
          maxLength={128}
          required
          data-autofocus
          error={wrong.name}
          {...input("name")}
        />
        {fields.role === "device" && (
          <DeviceInput
            label={t("settings.keys.device")}
            description={t("settings.keys.device_about")}
            required
            value={fields.device}
            onChange={(device) => onChange({ ...fields, device })}
            error={wrong.device_id}
          />
        )}
        <TextInput
          type="date"
          label={t("settings.keys.expires")}
          description={t("settings.keys.expires_about")}
          error={wrong.expires_at}
          {...input("lastDay")}
        />
        {error && Object.keys(wrong).length === 0 && (
          <Trouble title={t("settings.keys.could_not_make")} error={error} />
        )}
        <Group justify="flex-end" mt="xs">
          <Button variant="default" onClick={onCancel}>
            {t("common.cancel")}
          </Button>
          <Button type="submit" loading={pending}>
            {t("settings.keys.make")}
          </Button>
        </Group>
      </Stack>
    </form>
  );
}
