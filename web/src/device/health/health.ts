/** What became of a device's data, summed up for people. */
import type { Reception } from "../../api/types";
import { broken, brokenTime, gaps, median } from "../../lib/gaps";

export const PERIODS = [24, 168, 720] as const;
export type Period = (typeof PERIODS)[number];

/** The service lists no more. */
export const MOST_LOST = 100;
export const MOST_SESSIONS = 20;

export const total = (rejected: Reception["rejected"]): number =>
  Object.values(rejected).reduce((sum, number) => sum + number, 0);

/** Reasons, the most frequent first, with their percentage of everything that came. */
export function reasons({ rejected, samples, fixes }: Reception) {
  const all = samples + fixes + total(rejected);
  return Object.entries(rejected)
    .filter(([, number]) => number > 0)
    .sort(([, a], [, b]) => b - a)
    .map(([reason, number]) => ({ reason, number, percent: (100 * number) / all }));
}

/** How much of everything that came was not used. */
export function unusedPercent(health: Reception): number {
  return reasons(health).reduce((sum, { percent }) => sum + percent, 0);
}

/** How many chunks are lost. */
export function lostChunks({ lost }: Reception): number {
  return lost.reduce((sum, { from_seq, to_seq }) => sum + to_seq - from_seq + 1, 0);
}

/** The rate of most chunks, Hz. */
export function usual(rates: readonly (number | null)[]): number | null {
  return median(rates.filter((rate) => rate !== null));
}

export interface RateColumns {
  /** s since 1970 */
  time: number[];
  samples: (number | null)[];
  fixes: (number | null)[];
  rejected: (number | null)[];
}

/** The rates as columns for charts; a silence leaves a gap. */
export function rateColumns({
  time,
  sample_rate_hz,
  fix_rate_hz,
  rejected,
}: Reception["rates"]): RateColumns {
  const moments = time.map((moment) => Date.parse(moment) / 1000);
  const breaks = gaps(moments);
  return {
    time: brokenTime(moments, breaks),
    samples: broken(sample_rate_hz, breaks),
    fixes: broken(fix_rate_hz, breaks),
    rejected: broken(rejected, breaks),
  };
}

/** The least and the greatest of a column. */
export function ends(column: readonly (number | null)[]): [number, number] {
  const known = column.filter((value) => value !== null);
  return known.length === 0 ? [0, 0] : [Math.min(...known), Math.max(...known)];
}
