/** The angle history as data for charts. */
import type { Estimates } from "../../api/types";
import { unwrap } from "../../lib/angles";

export const ANGLES = ["roll", "pitch", "yaw"] as const;
export type Angle = (typeof ANGLES)[number];
type Column = (number | null)[];

export interface AngleHistory {
  /** s since 1970, ascending */
  time: number[];
  /** degrees without jumps at +-180, and the band of one sigma about them; null = gap */
  angles: Record<Angle, { value: Column; low: Column; high: Column }>;
  /** rows later than the rough alignment */
  settled: boolean[];
}

const ROUGH: ReadonlySet<string> = new Set(["waiting", "aligning"]);

/** s; neighbours further apart than this, and than a few usual steps, are not joined by a line */
const SHORTEST_GAP = 60;
const USUAL_STEPS = 8;

/** Columns for the charts; a new session or a long silence leaves a gap. */
export function angleHistory(estimates: Estimates): AngleHistory {
  const time = estimates.time.map((moment) => Date.parse(moment) / 1000);
  const breaks = gaps(time, estimates.session);
  const columns = ANGLES.map((angle, axis) => {
    const sigma = estimates.sigma_deg.map((row) => row[axis] ?? null);
    const value = unwrap(broken(estimates.angles_deg[angle], breaks, null));
    return [angle, band(value, broken(sigma, breaks, null))] as const;
  });
  return {
    time: broken(time, breaks, null).map((t, i, all) => t ?? ((all[i - 1] ?? 0) + (all[i + 1] ?? 0)) / 2),
    angles: Object.fromEntries(columns) as AngleHistory["angles"],
    settled: broken(estimates.stage, breaks, null).map((stage) => stage !== null && !ROUGH.has(stage)),
  };
}

/** Rows before which the line is interrupted. */
function gaps(time: readonly number[], session: readonly string[]): Set<number> {
  const steps = time.slice(1).map((t, i) => t - (time[i] ?? t));
  const usual = [...steps].sort((a, b) => a - b)[Math.floor(steps.length / 2)] ?? 0;
  const longest = Math.max(SHORTEST_GAP, USUAL_STEPS * usual);
  const found = steps.flatMap((step, i) => (step > longest || session[i] !== session[i + 1] ? [i + 1] : []));
  return new Set(found);
}

function broken<T, G>(column: readonly T[], breaks: ReadonlySet<number>, gap: G): (T | G)[] {
  return column.flatMap((value, row) => (breaks.has(row) ? [gap, value] : [value]));
}

function band(value: Column, sigma: Column) {
  const shifted = (sign: number) => value.map((v, i) => (v === null ? null : v + sign * (sigma[i] ?? 0)));
  return { value, low: shifted(-1), high: shifted(1) };
}

/** Degrees; the vertical axis never shows less, so that noise does not look like movement. */
const LEAST_SPAN = 4;
/** Range of the vertical axis: the band, without the first rough estimates where there are better ones. */
export function verticalRange({ angles, settled }: AngleHistory, angle: Angle): [number, number] {
  const { low, high } = angles[angle];
  const all = !settled.includes(true);
  const inside = [low, high].flatMap(
    (edge) => edge.filter((v, i) => v !== null && (all || settled[i])) as number[],
  );
  if (inside.length === 0) return [-LEAST_SPAN / 2, LEAST_SPAN / 2];
  const least = inside.reduce((a, b) => Math.min(a, b));
  const greatest = inside.reduce((a, b) => Math.max(a, b));
  const missing = Math.max(0, LEAST_SPAN - (greatest - least)) / 2 + 0.05 * (greatest - least);
  return [least - missing, greatest + missing];
}

export const RANGES = ["Hour", "Day", "All"] as const;
export type Range = (typeof RANGES)[number];
const SECONDS: Record<Range, number> = { Hour: 3600, Day: 86_400, All: Number.POSITIVE_INFINITY };

/**
 * Where a range begins, counted back from the last data and put on a whole minute, so that a live page does not ask for
 * another window with every sample. Null: at the beginning.
 */
export function rangeStart(range: Range, lastData: string | null): string | null {
  if (lastData === null || range === "All") return null;
  const minute = Math.floor(Date.parse(lastData) / 60_000) * 60_000;
  return new Date(minute - SECONDS[range] * 1000).toISOString();
}
