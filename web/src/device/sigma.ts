/** How sure the angles are, on a scale for bars. */

import type { Installation } from "../api/types";

/** Degrees, 1 sigma about vehicle x, y, z: the drive test begins below these. */
export function sigmaLimits({ tilt_sigma_deg, yaw_sigma_deg }: Installation["limits"]) {
  return [tilt_sigma_deg, tilt_sigma_deg, yaw_sigma_deg] as const;
}

/** Degrees; what the two ends of a bar stand for. */
const LEAST = 0.2;
const MOST = 20;

/** Place on the bar, 0..1, logarithmic: from "very sure" to "no idea". */
export function sigmaShare(sigma: number): number {
  const share = Math.log(sigma / LEAST) / Math.log(MOST / LEAST);
  return Math.min(Math.max(share, 0.03), 1);
}
