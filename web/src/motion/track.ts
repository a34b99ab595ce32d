/** The way that was driven, seen from above. */
import type { Drive } from "./drive";

export interface Place {
  x: number;
  y: number;
}

export interface Track {
  /** SVG paths in metres, north up; a gap where the position is not known */
  measured: string;
  /** carried on without a fix */
  reckoned: string;
  /** x, y, width and height of what is to be seen */
  box: [number, number, number, number];
  /** m, the length of the scale's bar */
  scale: number;
}

/** m; less is not worth a map */
const LEAST = 20;
/** share of the width */
const MARGIN = 0.08;

export function placeAt({ east, north }: Drive, row: number): Place | null {
  const [x, y] = [east[row], north[row]];
  return x == null || y == null ? null : { x, y: -y };
}

/** Null where no position is known. */
export function trackOf(drive: Drive): Track | null {
  const places = drive.time.map((_, row) => placeAt(drive, row));
  const box = boxOf(places);
  if (!box) return null;
  return {
    measured: path(places, (row) => !drive.reckoned[row]),
    reckoned: path(places, (row) => drive.reckoned[row] === true),
    box,
    scale: barOf(box[2]),
  };
}

/** Lines between neighbours that are both known; a line belongs to the kind of its later end. */
function path(places: readonly (Place | null)[], belongs: (row: number) => boolean): string {
  let text = "";
  let pen = -1;
  places.forEach((place, row) => {
    const before = places[row - 1];
    if (!place || !before || !belongs(row)) return;
    if (pen !== row - 1) text += `M${before.x.toFixed(1)} ${before.y.toFixed(1)}`;
    text += `L${place.x.toFixed(1)} ${place.y.toFixed(1)}`;
    pen = row;
  });
  return text;
}

function boxOf(places: readonly (Place | null)[]): [number, number, number, number] | null {
  let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const place of places) {
    if (!place) continue;
    left = Math.min(left, place.x);
    right = Math.max(right, place.x);
    top = Math.min(top, place.y);
    bottom = Math.max(bottom, place.y);
  }
  if (left > right) return null;
  const size = Math.max(right - left, bottom - top, LEAST) * (1 + 2 * MARGIN);
  const [x, y] = [(left + right) / 2, (top + bottom) / 2];
  return [x - size / 2, y - size / 2, size, size];
}

/** A round number of metres, about a quarter of the width. */
export function barOf(width: number): number {
  const power = 10 ** Math.floor(Math.log10(width / 4));
  const steps = width / 4 / power;
  return power * (steps >= 5 ? 5 : steps >= 2 ? 2 : 1);
}
