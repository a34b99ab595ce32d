import { Checkbox } from "@mantine/core";
import css from "./settings.module.css";

interface ChoiceProps<T extends string> {
  label: string;
  /** the word for everything */
  all: string;
  of: readonly { value: T; label: string }[];
  /** null: everything, also what there may be later */
  chosen: readonly T[] | null;
  onChange: (chosen: T[] | null) => void;
}

/** Everything, or some of it. */
export function Choice<T extends string>({ label, all, of, chosen, onChange }: ChoiceProps<T>) {
  const toggled = (value: T, on: boolean) =>
    on ? [...(chosen ?? []), value] : (chosen ?? []).filter((other) => other !== value);
  return (
    <fieldset className={css.choice}>
      <legend>{label}</legend>
      <Checkbox
        size="md"
        label={all}
        checked={chosen === null}
        onChange={(event) => onChange(event.currentTarget.checked ? null : of.map(({ value }) => value))}
      />
      {chosen !== null && (
        <div className={css.options}>
          {of.map(({ value, label: name }) => (
            <Checkbox
              key={value}
              size="md"
              label={name}
              checked={chosen.includes(value)}
              onChange={(event) => onChange(toggled(value, event.currentTarget.checked))}
            />
          ))}
        </div>
      )}
    </fieldset>
  );
}
