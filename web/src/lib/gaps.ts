/** Where a line over time is interrupted. */

/** s; neighbours further apart than this, and than a few usual steps, are not joined by a line */
const SHORTEST_GAP = 60;
const USUAL_STEPS = 8;

/** Rows before which the line is interrupted: by a long silence, or where another group (such as a session) begins. */
export function gaps(time: readonly number[], group: readonly string[] = []): Set<number> {
  const steps = time.slice(1).map((t, i) => t - (time[i] ?? t));
  const longest = Math.max(SHORTEST_GAP, USUAL_STEPS * (median(steps) ?? 0));
  return new Set(steps.flatMap((step, i) => (step > longest || group[i] !== group[i + 1] ? [i + 1] : [])));
}

/** The column with a row of nothing in each gap. */
export function broken<T>(column: readonly T[], breaks: ReadonlySet<number>): (T | null)[] {
  return column.flatMap((value, row) => (breaks.has(row) ? [null, value] : [value]));
}

/** The times with a row in the middle of each gap. */
export function brokenTime(time: readonly number[], breaks: ReadonlySet<number>): number[] {
  return broken(time, breaks).map((t, i, all) => t ?? ((all[i - 1] ?? 0) + (all[i + 1] ?? 0)) / 2);
}

export function median(values: readonly number[]): number | null {
  return [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)] ?? null;
}
