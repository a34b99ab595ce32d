/** The friction circle: how much of the tyres' grip was used, forwards and sideways. */
import type { Drive } from "./drive";
import { GRAVITY } from "./drive";

/** g; rings that are drawn as far as they are needed */
const RINGS = [0.2, 0.4, 0.6, 0.8, 1, 1.5, 2, 3, 5, 10, 20, 40];

export interface Dot {
  /** g to the right of the paper: the vehicle's right */
  right: number;
  /** g up the paper: forward */
  up: number;
}

/** A row's acceleration on the plan; null where it is not known. */
export function dotAt({ longitudinal, lateral }: Drive, row: number): Dot | null {
  const [forward, left] = [longitudinal[row], lateral[row]];
  if (forward == null || left == null) return null;
  return { right: -left / GRAVITY, up: forward / GRAVITY };
}

export function dotsOf(drive: Drive): Dot[] {
  return drive.time.flatMap((_, row) => dotAt(drive, row) ?? []);
}

export const sizeOf = ({ right, up }: Dot): number => Math.hypot(right, up);

/** The rings to draw, g: up to the first that holds everything. */
export function rings(dots: readonly Dot[]): number[] {
  const most = Math.max(0, ...dots.map(sizeOf));
  const last = RINGS.findIndex((ring) => ring >= most);
  const end = last < 0 ? RINGS.length : Math.max(last, 1) + 1;
  return RINGS.slice(Math.max(0, end - 4), end);
}
