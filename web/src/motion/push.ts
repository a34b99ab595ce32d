/** Where a push came from, in words and in a drawing. */
import { t } from "../text";

/** Every 45 degrees, anti-clockwise from the front. */
const SIDES = [
  "front",
  "front_left",
  "left",
  "rear_left",
  "rear",
  "rear_right",
  "right",
  "front_right",
] as const;
export type Side = (typeof SIDES)[number];

/** degrees anti-clockwise from the front: the side from which it came */
export function sideOf(direction: number): Side {
  const place = Math.round(direction / 45) & 7;
  return SIDES[place] ?? "front";
}

export const fromWhere = (direction: number): string => t(`motion.side.${sideOf(direction)}`);

/** On a drawing with the front up: x to the right, y down; where the arrow begins, one unit from the middle. */
export function origin(direction: number): { x: number; y: number } {
  const angle = (direction * Math.PI) / 180;
  return { x: -Math.sin(angle), y: -Math.cos(angle) };
}

/** Clock position as crash reports give it: 12 is the front, 3 the right side. */
export function oClock(direction: number): number {
  const hour = Math.round((((-direction % 360) + 360) % 360) / 30) % 12;
  return hour === 0 ? 12 : hour;
}
