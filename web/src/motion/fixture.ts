/** For tests: a stretch of driving, a row each second. */
import type { Drive } from "./drive";

export function drive(over: Partial<Drive> = {}, rows = 4): Drive {
  const zeros = Array.from({ length: rows }, () => 0);
  return {
    time: zeros.map((_, row) => 1000 + row),
    longitudinal: zeros,
    lateral: zeros,
    vertical: zeros,
    speed: zeros,
    yaw_rate: zeros,
    sideslip: zeros,
    roll: zeros,
    pitch: zeros,
    heading: zeros,
    east: zeros,
    north: zeros,
    reckoned: zeros.map(() => false),
    ...over,
  };
}
