import { ActionIcon, Button, Checkbox } from "@mantine/core";
import { X } from "lucide-react";
import type { Verb } from "../api/alerts";
import type { Alert } from "../api/types";
import { whole } from "../lib/format";
import { t } from "../text";
import css from "./alerts.module.css";
import { isDue } from "./settling";

interface SelectAllProps {
  of: readonly Alert[];
  chosen: readonly Alert[];
  onChange: (selected: ReadonlySet<number>) => void;
}

export function SelectAll({ of, chosen, onChange }: SelectAllProps) {
  const all = chosen.length === of.length;
  return (
    <Checkbox
      className={css.selectAll}
      label={t("alerts.select.all")}
      checked={all}
      indeterminate={chosen.length > 0 && !all}
      onChange={() => onChange(new Set(all ? [] : of.map(({ id }) => id)))}
    />
  );
}

interface SelectionBarProps {
  chosen: readonly Alert[];
  onChange: (selected: ReadonlySet<number>) => void;
  onSettle: (alerts: readonly Alert[], verb: Verb) => void;
}

/** What can be done with all that are selected, at hand at the bottom of the screen. */
export function SelectionBar({ chosen, onChange, onSettle }: SelectionBarProps) {
  const [count, number] = [chosen.length, whole(chosen.length)];
  return (
    <section className={css.bar} aria-label={t("alerts.select.bar")}>
      <strong>{t("alerts.select.count", { count, number })}</strong>
      <ActionIcon aria-label={t("alerts.select.none")} color="gray" onClick={() => onChange(new Set())}>
        <X size={20} aria-hidden />
      </ActionIcon>
      <div className={css.barActions}>
        <Action verb="acknowledge" chosen={chosen} onSettle={onSettle} />
        <Action verb="resolve" chosen={chosen} onSettle={onSettle} />
      </div>
    </section>
  );
}

interface ActionProps {
  verb: Verb;
  chosen: readonly Alert[];
  onSettle: SelectionBarProps["onSettle"];
}

function Action({ verb, chosen, onSettle }: ActionProps) {
  const due = chosen.filter((alert) => isDue(alert, verb));
  return (
    <Button
      variant={verb === "resolve" ? "filled" : "default"}
      disabled={due.length === 0}
      onClick={() => onSettle(due, verb)}
    >
      {t(`alerts.select.${verb}`, { number: whole(due.length) })}
    </Button>
  );
}
