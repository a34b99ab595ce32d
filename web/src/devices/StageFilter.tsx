import { TriangleAlert } from "lucide-react";
import type { DeviceFilter } from "../api/keys";
import type { FleetSummary } from "../api/types";
import { STAGES, stageWord } from "../lib/stages";
import css from "./devices.module.css";

interface StageFilterProps {
  filter: DeviceFilter;
  onChange: (filter: DeviceFilter) => void;
  summary: FleetSummary | undefined;
}

/** Counts that are filters: press "Verifying 3" to see those three. */
export function StageFilter({ filter, onChange, summary }: StageFilterProps) {
  const all = filter.stage === "" && !filter.hasOpenAlert;
  return (
    <fieldset className={css.chips}>
      <legend className="visually-hidden">Filter by stage</legend>
      <Chip
        word="All"
        count={summary?.devices}
        pressed={all}
        onPress={() => onChange({ ...filter, stage: "", hasOpenAlert: false })}
      />
      {STAGES.map((stage) => (
        <Chip
          key={stage}
          word={stageWord(stage)}
          count={summary && (summary.stages[stage] ?? 0)}
          pressed={filter.stage === stage}
          onPress={() => onChange({ ...filter, stage: filter.stage === stage ? "" : stage })}
        />
      ))}
      <Chip
        word="With alerts"
        alert
        count={undefined}
        pressed={filter.hasOpenAlert}
        onPress={() => onChange({ ...filter, hasOpenAlert: !filter.hasOpenAlert })}
      />
    </fieldset>
  );
}

interface ChipProps {
  word: string;
  count: number | undefined;
  pressed: boolean;
  onPress: () => void;
  alert?: boolean;
}

function Chip({ word, count, pressed, onPress, alert }: ChipProps) {
  return (
    <button type="button" className={css.chip} aria-pressed={pressed} onClick={onPress}>
      {alert && <TriangleAlert size={16} aria-hidden />}
      {word}
      {count !== undefined && <b>{count}</b>}
    </button>
  );
}
