import { LayoutGrid, type LucideIcon } from "lucide-react";
import type { ReactNode } from "react";
import type { DeviceFilter } from "../api/keys";
import type { FleetSummary } from "../api/types";
import { whole } from "../lib/format";
import { STAGE, STAGES, stageWord, type Tone } from "../lib/stages";
import { t } from "../text";
import { countOf, type Narrowing, SEVERITIES, SILENT, SUSPECT, writeFilter } from "./filter";
import { SEVERITY, SILENT_LOOK, SUSPECT_LOOK } from "./look";
import css from "./tiles.module.css";
import type { Change } from "./useFilter";

interface TilesProps {
  filter: DeviceFilter;
  onChange: Change;
  summary: FleetSummary | undefined;
}

/** No tile narrows the list: what is searched, and the order, stay. */
const ALL: Required<Narrowing> = { stage: "", alert_severity: "", alert_kind: "", mount_status: "" };

/** The fleet in counts, and each count a filter: press "Verifying 3" to see those three. */
export function Tiles({ filter, onChange, summary }: TilesProps) {
  const tile = (narrowing: Narrowing, word: string, look: { icon: LucideIcon; tone: Tone }) => (
    <NarrowingTile key={word} {...{ narrowing, word, filter, onChange, summary, ...look }} />
  );
  return (
    <div className={css.tiles}>
      <Strip label={t("devices.by_stage")}>
        <Tile
          word={t("devices.all")}
          icon={LayoutGrid}
          count={summary?.devices}
          pressed={writeFilter({ ...filter, ...ALL }) === writeFilter(filter)}
          onPress={() => onChange(ALL)}
        />
        {STAGES.map((stage) => tile({ stage }, stageWord(stage), STAGE[stage]))}
      </Strip>
      <Strip label={t("devices.by_alert")}>
        {SEVERITIES.map((alert_severity) =>
          tile({ alert_severity }, t(`devices.severity.${alert_severity}`), SEVERITY[alert_severity]),
        )}
        {tile({ alert_kind: SILENT }, t("devices.silent"), SILENT_LOOK)}
        {tile({ mount_status: SUSPECT }, t("devices.suspect"), SUSPECT_LOOK)}
      </Strip>
    </div>
  );
}

function Strip({ label, children }: { label: string; children: ReactNode }) {
  return (
    <fieldset className={css.strip}>
      <legend className="visually-hidden">{label}</legend>
      {children}
    </fieldset>
  );
}

interface NarrowingTileProps extends TilesProps {
  narrowing: Narrowing;
  word: string;
  icon: LucideIcon;
  tone: Tone;
}

/** Narrows the list when pressed, and widens it again when pressed once more. */
function NarrowingTile({ narrowing, filter, onChange, summary, tone, ...look }: NarrowingTileProps) {
  const [[name, value] = []] = Object.entries(narrowing) as [keyof Narrowing, string][];
  const pressed = name !== undefined && filter[name] === value;
  const count = summary && countOf(narrowing, summary);
  return (
    <Tile
      {...look}
      tone={count ? tone : "neutral"}
      count={count}
      pressed={pressed}
      onPress={() => name && onChange(pressed ? { [name]: "" } : narrowing)}
    />
  );
}

interface TileProps {
  word: string;
  icon: LucideIcon;
  tone?: Tone;
  /** undefined: not known yet */
  count: number | undefined;
  pressed: boolean;
  onPress: () => void;
}

function Tile({ word, icon: Icon, tone = "accent", count, pressed, onPress }: TileProps) {
  return (
    <button type="button" className={css.tile} data-tone={tone} aria-pressed={pressed} onClick={onPress}>
      <Icon size={18} aria-hidden />
      <span>{word} </span>
      <b>{count === undefined ? "–" : whole(count)}</b>
    </button>
  );
}
