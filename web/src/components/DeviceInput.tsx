import { TextInput } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useId } from "react";
import { useDeviceChoices } from "../api/deviceChoices";

interface DeviceInputProps {
  label: string;
  placeholder?: string;
  description?: string;
  /** id of a device */
  value: string;
  onChange: (id: string) => void;
  required?: boolean;
  error?: string | undefined;
}

/** The id of a device; while it is typed, the browser offers those whose name, id or vehicle fits. */
export function DeviceInput({ value, onChange, ...input }: DeviceInputProps) {
  const list = useId();
  const [q] = useDebouncedValue(value.trim(), 250);
  const choices = useDeviceChoices(q);
  return (
    <>
      <TextInput
        {...input}
        list={list}
        value={value}
        onChange={(event) => onChange(event.currentTarget.value)}
        maxLength={64}
        autoCapitalize="off"
        autoComplete="off"
        spellCheck={false}
      />
      <datalist id={list}>
        {choices.map(({ id, name }) => (
          <option key={id} value={id}>
            {name}
          </option>
        ))}
      </datalist>
    </>
  );
}
