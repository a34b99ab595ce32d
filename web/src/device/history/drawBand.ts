/**
 * Draws the band of one sigma. uPlot's own bands cut one path out of another, and of ten thousand points that alone takes
 * longer than a frame lasts while the chart is moved.
 */
import uPlot from "uplot";

export interface Edges {
  low: readonly (number | null)[];
  high: readonly (number | null)[];
}

/** A place along the time axis with what the band spans there. */
export interface Slice {
  x: number;
  low: number;
  high: number;
}

/** CSS pixels; the edges are no finer. */
const FINEST = 2;

export function drawBand(plot: uPlot, edges: Edges, colour: string): void {
  const { ctx, bbox, scales } = plot;
  const { min: x0, max: x1 } = scales.x ?? {};
  const { min: y0, max: y1 } = scales.y ?? {};
  if (x0 == null || x1 == null || y0 == null || y1 == null) return;
  const [right, up] = [bbox.width / (x1 - x0), bbox.height / (y1 - y0)];
  const time = plot.data[0];
  const rows = [plot.valToIdx(x0) - 1, plot.valToIdx(x1) + 1] as const;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.fillStyle = colour;
  const place = (row: number) => bbox.left + ((time[row] ?? x0) - x0) * right;
  for (const piece of slices(edges, rows, place, FINEST * uPlot.pxRatio)) {
    ctx.beginPath();
    for (const { x, high } of piece) ctx.lineTo(x, bbox.top + (y1 - high) * up);
    for (const { x, low } of piece.reverse()) ctx.lineTo(x, bbox.top + (y1 - low) * up);
    ctx.fill();
  }
  ctx.restore();
}

/** The band between two rows, in pieces where there are gaps; rows nearer than `finest` are taken together. */
export function slices(
  { low, high }: Edges,
  [from, to]: readonly [number, number],
  place: (row: number) => number,
  finest: number,
): Slice[][] {
  const pieces: Slice[][] = [[]];
  let last: Slice | undefined;
  for (let row = Math.max(from, 0); row <= Math.min(to, low.length - 1); row++) {
    const [least, most] = [low[row], high[row]];
    if (least == null || most == null) {
      if (last) pieces.push([]);
      last = undefined;
      continue;
    }
    const x = place(row);
    if (last && x - last.x < finest) {
      last.low = Math.min(last.low, least);
      last.high = Math.max(last.high, most);
      continue;
    }
    last = { x, low: least, high: most };
    pieces.at(-1)?.push(last);
  }
  return pieces.filter((piece) => piece.length > 0);
}
