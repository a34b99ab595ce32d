import { Button, Group, Stack, Textarea, TextInput } from "@mantine/core";
import { ScanLine } from "lucide-react";
import { type FormEvent, useState } from "react";
import { Problem } from "../../api/http";
import type { DeviceDraft } from "../../api/types";
import { Trouble } from "../../components/States";
import { t } from "../../text";
import css from "./form.module.css";
import type { Found } from "./scannedId";

export const EMPTY = { name: "", vehicle: "", id: "", notes: "" };
export type Fields = typeof EMPTY;

/** The control that has the focus at first. */
export type Start = "name" | "id" | "scan";

/** What was left empty is left out, so that the service fills it in. */
export function draft(fields: Fields): DeviceDraft {
  const given = Object.entries(fields).map(([name, value]) => [name, value.trim() || null]);
  return { ...Object.fromEntries(given), name: fields.name.trim() };
}

interface DeviceFormProps {
  fields: Fields;
  onChange: (fields: Fields) => void;
  /** the last code that was scanned */
  scanned: Found | null;
  start: Start;
  onScan: () => void;
  onSubmit: () => void;
  onCancel: () => void;
  pending: boolean;
  error: Error | null;
}

export function DeviceForm(props: DeviceFormProps) {
  const { fields, onChange, error } = props;
  const [hasNotes, setHasNotes] = useState(fields.notes !== "");
  const wrong = error instanceof Problem ? error.fields : {};
  const input = (name: keyof Fields) => ({
    value: fields[name],
    onChange: (event: { currentTarget: { value: string } }) =>
      onChange({ ...fields, [name]: event.currentTarget.value }),
    error: wrong[name],
  });
  const submit = (event: FormEvent) => {
    event.preventDefault();
    props.onSubmit();
  };
  const unexplained = error !== null && Object.keys(wrong).length === 0;
  return (
    <form onSubmit={submit}>
      <Stack>
        <TextInput
          label={t("devices.form.name")}
          placeholder={t("devices.form.name_example")}
          maxLength={128}
          required
          data-autofocus
          {...input("name")}
        />
        <TextInput
          label={t("devices.form.vehicle")}
          placeholder={t("devices.form.vehicle_example")}
          maxLength={128}
          {...input("vehicle")}
        />
        <IdField {...props} {...input("id")} />
        {hasNotes && (
          <Textarea
            label={t("devices.form.notes")}
            autosize
            minRows={2}
            maxLength={4000}
            {...input("notes")}
          />
        )}
        {!hasNotes && (
          <Button variant="subtle" size="sm" w="fit-content" px="xs" onClick={() => setHasNotes(true)}>
            {t("devices.form.more")}
          </Button>
        )}
        {unexplained && (
          <Trouble title={t("common.could_not", { what: t("devices.form.add_it") })} error={error} />
        )}
        <Group justify="flex-end" mt="xs">
          <Button variant="default" onClick={props.onCancel}>
            {t("common.cancel")}
          </Button>
          <Button type="submit" loading={props.pending}>
            {t("devices.form.submit")}
          </Button>
        </Group>
      </Stack>
    </form>
  );
}

type IdFieldProps = Pick<DeviceFormProps, "scanned" | "start" | "onScan"> & {
  value: string;
  onChange: (event: { currentTarget: { value: string } }) => void;
  error: string | undefined;
};

function IdField({ scanned, start, onScan, value, onChange, error }: IdFieldProps) {
  const isScanned = scanned?.id === value;
  return (
    <div className={css.id}>
      <TextInput
        label={t("devices.form.id")}
        aria-describedby="id-about"
        pattern="[A-Za-z0-9][A-Za-z0-9._:\-]{0,63}"
        autoCapitalize="off"
        spellCheck={false}
        autoFocus={start === "id"}
        value={value}
        onChange={onChange}
        error={error}
      />
      <Button
        variant="default"
        leftSection={<ScanLine size={20} aria-hidden />}
        aria-label={t("devices.form.scan_id")}
        onClick={onScan}
        autoFocus={start === "scan"}
      >
        {t("devices.form.scan")}
      </Button>
      <p id="id-about">{t("devices.form.id_about")}</p>
      <p role="status">
        {isScanned && t("devices.form.scanned", { id: value })}
        {isScanned && scanned.isProductCode && ` ${t("devices.form.product_code")}`}
      </p>
    </div>
  );
}
