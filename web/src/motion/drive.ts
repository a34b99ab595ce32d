/** A stretch of driving as the charts want it: columns over time, in the units people read. */
import type { Motion } from "../api/types";
import type { Quaternion } from "../lib/rotation";
import { fromAngles } from "../lib/rotation";

export const GRAVITY = 9.80665;
const KMH = 3.6;

export type Column = readonly (number | null)[];

export interface Drive {
  /** s since 1970 */
  time: number[];
  /** m/s² */
  longitudinal: Column;
  lateral: Column;
  vertical: Column;
  /** km/h */
  speed: Column;
  /** degrees a second, to the left positive */
  yaw_rate: Column;
  /** degrees */
  sideslip: Column;
  roll: Column;
  pitch: Column;
  /** degrees clockwise from north */
  heading: Column;
  /** m from the origin */
  east: Column;
  north: Column;
  /** no fix: the position is carried on */
  reckoned: readonly boolean[];
}

export function driveOf({ columns: c }: Motion): Drive {
  return {
    time: c.at.map((moment) => Date.parse(moment) / 1000),
    longitudinal: c.longitudinal_mps2,
    lateral: c.lateral_mps2,
    vertical: c.vertical_mps2,
    speed: c.speed_mps.map((speed) => (speed === null ? null : speed * KMH)),
    yaw_rate: c.yaw_rate_dps,
    sideslip: c.sideslip_deg,
    roll: c.roll_deg,
    pitch: c.pitch_deg,
    heading: c.heading_deg,
    east: c.east_m,
    north: c.north_m,
    reckoned: c.dead_reckoned,
  };
}

/** The row nearest to a moment. */
export function rowAt(time: readonly number[], moment: number): number {
  let [low, high] = [0, time.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((time[middle] ?? 0) <= moment) low = middle;
    else high = middle;
  }
  return Math.abs((time[high] ?? 0) - moment) < Math.abs((time[low] ?? 0) - moment) ? high : low;
}

/** Tilt of the vehicle's body, drawn so many times as large; its heading is told by the map. */
export function tilt({ roll, pitch }: Drive, row: number, times: number): Quaternion {
  return fromAngles({ roll: (roll[row] ?? 0) * times, pitch: (pitch[row] ?? 0) * times, yaw: 0 });
}

/** Least and greatest of several columns; null where nothing is known. */
export function reach(...columns: Column[]): [number, number] | null {
  let [least, most] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (const column of columns)
    for (const value of column) {
      if (value === null) continue;
      least = Math.min(least, value);
      most = Math.max(most, value);
    }
  return least <= most ? [least, most] : null;
}
