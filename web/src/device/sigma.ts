/** How sure the angles are, on a scale for bars. */

/** Degrees, 1 sigma about vehicle x, y, z: a mounting is RELIABLE below these (`core.DEFAULT.settling`). */
export const SIGMA_LIMIT = [1.4, 1.4, 1.8] as const;

/** Degrees; what the two ends of a bar stand for. */
const LEAST = 0.2;
const MOST = 20;

/** Place on the bar, 0..1, logarithmic: from "very sure" to "no idea". */
export function sigmaShare(sigma: number): number {
  const share = Math.log(sigma / LEAST) / Math.log(MOST / LEAST);
  return Math.min(Math.max(share, 0.03), 1);
}
