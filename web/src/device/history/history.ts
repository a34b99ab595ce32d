/** The angle history as data for charts. */
import type { Estimates } from "../../api/types";
import { unwrap } from "../../lib/angles";
import { broken, brokenTime, gaps } from "../../lib/gaps";
import type { Span } from "./span";

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

/** Columns for the charts; a new session or a long silence leaves a gap. */
export function angleHistory(estimates: Estimates): AngleHistory {
  const time = estimates.time.map((moment) => Date.parse(moment) / 1000);
  const breaks = gaps(time, estimates.session);
  const columns = ANGLES.map((angle, axis) => {
    const sigma = estimates.sigma_deg.map((row) => row[axis] ?? null);
    const value = unwrap(broken(estimates.angles_deg[angle], breaks));
    return [angle, band(value, broken(sigma, breaks))] as const;
  });
  return {
    time: brokenTime(time, breaks),
    angles: Object.fromEntries(columns) as AngleHistory["angles"],
    settled: broken(estimates.stage, breaks).map((stage) => stage !== null && !ROUGH.has(stage)),
  };
}

function band(value: Column, sigma: Column) {
  const shifted = (sign: number) => value.map((v, i) => (v === null ? null : v + sign * (sigma[i] ?? 0)));
  return { value, low: shifted(-1), high: shifted(1) };
}

/** s; so much is shown on both sides of a single estimate */
const ALONE = 30;

/** What there is of it, from the first estimate to the last. */
export function extentOf({ time }: AngleHistory): Span | null {
  const [min, max] = [time[0], time.at(-1)];
  if (min === undefined || max === undefined) return null;
  return min < max ? { min, max } : { min: min - ALONE, max: max + ALONE };
}

/** Degrees; the vertical axis never shows less, so that noise does not look like movement. */
const LEAST_SPAN = 4;

/** Range of the vertical axis: the band within a span, without the first rough estimates where there are better ones. */
export function verticalRange(history: AngleHistory, angle: Angle, span: Span | null): [number, number] {
  const { low, high } = history.angles[angle];
  const rows = rowsIn(history, span);
  const better = rows.filter((row) => history.settled[row]);
  let [least, greatest] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (const row of better.length > 0 ? better : rows) {
    least = Math.min(least, low[row] ?? least);
    greatest = Math.max(greatest, high[row] ?? greatest);
  }
  if (least > greatest) return [-LEAST_SPAN / 2, LEAST_SPAN / 2];
  const missing = Math.max(0, LEAST_SPAN - (greatest - least)) / 2 + 0.05 * (greatest - least);
  return [least - missing, greatest + missing];
}

function rowsIn({ time }: AngleHistory, span: Span | null): number[] {
  return time.flatMap((t, row) => (span === null || (t >= span.min && t <= span.max) ? [row] : []));
}

/** The row whose values are told: the one under the cursor, else the last of the span that has any. */
export function toldRow(
  history: AngleHistory,
  angle: Angle,
  cursor: number | null,
  span: Span | null,
): number {
  const { value } = history.angles[angle];
  if (cursor !== null && value[cursor] != null) return cursor;
  return value.findLastIndex(
    (v, row) => v !== null && (span === null || (history.time[row] ?? 0) <= span.max),
  );
}
