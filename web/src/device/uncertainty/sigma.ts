/** How sure the angles are: on a scale for bars, and over time. */
import type { TimeRange } from "../../api/keys";
import type { Estimates, Installation } from "../../api/types";

/** Degrees, 1 sigma about vehicle x, y, z: the drive test begins below these. */
export function sigmaLimits({ tilt_sigma_deg, yaw_sigma_deg }: Installation["limits"]) {
  return [tilt_sigma_deg, tilt_sigma_deg, yaw_sigma_deg] as const;
}

/** Degrees; what the two ends of a bar, and of the chart's axis, stand for. */
export const SCALE = { least: 0.2, most: 20 };

/** Place on the bar, 0..1, logarithmic: from "very sure" to "no idea". */
export function sigmaShare(sigma: number): number {
  const share = Math.log(sigma / SCALE.least) / Math.log(SCALE.most / SCALE.least);
  return Math.min(Math.max(share, 0.03), 1);
}

/** ms of history that are looked at, and how much of what followed a confirmed mounting */
const LOOK_BACK = 30 * 60_000;
const LOOK_BEYOND = 2 * 60_000;
const MINUTE = 60_000;

/**
 * The calibration that led to what is known: before the confirmation, or before the last data. On whole minutes, so that
 * a live page does not ask for another window with every chunk.
 */
export function calibrationRange({ mount, last_data_at }: Installation): TimeRange {
  if (mount?.status === "in_force") {
    const confirmed = Date.parse(mount.confirmed_at);
    return { from: moment(confirmed - LOOK_BACK), to: moment(confirmed + LOOK_BEYOND) };
  }
  return { from: last_data_at && moment(Date.parse(last_data_at) - LOOK_BACK), to: null };
}

function moment(time: number): string {
  return new Date(Math.floor(time / MINUTE) * MINUTE).toISOString();
}

type Column = (number | null)[];

export interface SigmaHistory {
  /** s since 1970, ascending */
  time: number[];
  /** degrees about vehicle x, y and z; null = nothing came in between */
  sigma: [Column, Column, Column];
}

/** s; rows further apart are not joined by a line */
const GAP = 60;

export function sigmaHistory(estimates: Estimates): SigmaHistory {
  const rows = estimates.time.map((text, row) => ({
    time: Date.parse(text) / 1000,
    sigma: estimates.sigma_deg[row],
  }));
  const broken = rows.flatMap((row, i) => {
    const before = rows[i - 1];
    const silent = before && row.time - before.time > GAP;
    return silent ? [{ time: (before.time + row.time) / 2, sigma: undefined }, row] : [row];
  });
  const column = (axis: number) => broken.map(({ sigma }) => sigma?.[axis] ?? null);
  return { time: broken.map(({ time }) => time), sigma: [column(0), column(1), column(2)] };
}

/** Range of the chart's axis, degrees: all that is drawn, and the limits in sight. */
export function sigmaRange({ sigma }: SigmaHistory, limits: readonly number[]): [number, number] {
  const all = [...sigma.flat(), ...limits].filter((value) => value !== null);
  const least = all.reduce((a, b) => Math.min(a, b), SCALE.most);
  const most = all.reduce((a, b) => Math.max(a, b), SCALE.least);
  return [0.8 * least, 1.25 * Math.min(most, 180)];
}
