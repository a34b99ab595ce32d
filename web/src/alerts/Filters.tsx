import { Button, NativeSelect, TextInput } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { ListFilter } from "lucide-react";
import type { AlertFilter } from "../api/keys";
import { DeviceInput } from "../components/DeviceInput";
import { t } from "../text";
import css from "./alerts.module.css";
import { filtersSet, KINDS, SEVERITIES, STATES, UNFILTERED } from "./filters";

interface FiltersProps {
  filter: AlertFilter;
  onChange: (filter: AlertFilter) => void;
}

/** Which alerts to show: the states at one press, the rest folded away on a phone. */
export function Filters({ filter, onChange }: FiltersProps) {
  const set = filtersSet(filter);
  const [more, { toggle }] = useDisclosure(set > 0);
  return (
    <search className={css.filters} aria-label={t("alerts.filter.label")}>
      <States state={filter.state} onChange={(state) => onChange({ ...filter, state })} />
      <Button
        className={css.more}
        variant="default"
        leftSection={<ListFilter size={18} aria-hidden />}
        onClick={toggle}
        aria-expanded={more}
      >
        {t("alerts.filter.more")}
        {set > 0 && <b className={css.set}>{set}</b>}
      </Button>
      <div className={css.fields} data-open={more || undefined}>
        <Fields filter={filter} onChange={onChange} />
        {set > 0 && (
          <Button variant="default" onClick={() => onChange({ ...UNFILTERED, state: filter.state })}>
            {t("alerts.filter.clear")}
          </Button>
        )}
      </div>
    </search>
  );
}

type State = AlertFilter["state"];

function States({ state, onChange }: { state: State; onChange: (state: State) => void }) {
  return (
    <fieldset className={css.chips}>
      <legend className="visually-hidden">{t("alerts.filter.state")}</legend>
      {STATES.map((name) => (
        <button
          key={name}
          type="button"
          className={css.chip}
          aria-pressed={name === state}
          onClick={() => onChange(name)}
        >
          {t(`alerts.filter.${name}`)}
        </button>
      ))}
    </fieldset>
  );
}

function Fields({ filter, onChange }: FiltersProps) {
  const change = (name: keyof AlertFilter) => (event: { currentTarget: { value: string } }) =>
    onChange({ ...filter, [name]: event.currentTarget.value });
  const kinds = KINDS.map((value) => ({ value, label: t(`alerts.kind.${value}`) }));
  const severities = SEVERITIES.map((value) => ({ value, label: t(`alerts.severity.${value}`) }));
  return (
    <>
      <NativeSelect
        size="md"
        label={t("alerts.filter.kind")}
        data={[{ value: "", label: t("alerts.filter.every_kind") }, ...kinds]}
        value={filter.kind}
        onChange={change("kind")}
      />
      <NativeSelect
        size="md"
        label={t("alerts.filter.severity")}
        data={[{ value: "", label: t("alerts.filter.every_severity") }, ...severities]}
        value={filter.severity}
        onChange={change("severity")}
      />
      <DeviceInput
        label={t("alerts.filter.device")}
        placeholder={t("alerts.filter.device_hint")}
        value={filter.deviceId}
        onChange={(deviceId) => onChange({ ...filter, deviceId })}
      />
      <TextInput
        type="date"
        label={t("alerts.filter.from")}
        max={filter.to}
        value={filter.from}
        onChange={change("from")}
      />
      <TextInput
        type="date"
        label={t("alerts.filter.to")}
        min={filter.from}
        value={filter.to}
        onChange={change("to")}
      />
    </>
  );
}
