/** Draws marks into a chart: a line each, and in the uppermost chart a flag where there is room for one. */
import uPlot from "uplot";
import { flagged, type Mark, type MarkKind, within } from "./marks";

interface Look {
  /** variable of the page */
  colour: string;
  /** pixels on and off; nothing: drawn through */
  dash: number[];
  width: number;
}

/** The kinds differ in their dashes too, for those who do not tell the colours apart. */
export const MARK_LOOK: Record<MarkKind, Look> = {
  opened: { colour: "--livella-bad", dash: [], width: 2 },
  resolved: { colour: "--livella-bad", dash: [2, 3], width: 1.5 },
  mount: { colour: "--livella-good", dash: [], width: 1.5 },
  stage: { colour: "--livella-accent", dash: [6, 4], width: 1 },
  session: { colour: "--mantine-color-dimmed", dash: [1, 3], width: 1 },
};

/** Pixels. */
const FLAG = { height: 15, pad: 4 };

export interface Ink {
  colours: Record<MarkKind, string>;
  ground: string;
  font: string;
}

/** The colours of an element, read once: reading them at each frame would be slow. */
export function inkOf(element: HTMLElement): Ink {
  const style = getComputedStyle(element);
  const colours = Object.entries(MARK_LOOK).map(([kind, { colour }]) => [
    kind,
    style.getPropertyValue(colour),
  ]);
  return {
    colours: Object.fromEntries(colours) as Ink["colours"],
    ground: style.getPropertyValue("--livella-card"),
    font: `600 ${11 * uPlot.pxRatio}px ${style.fontFamily}`,
  };
}

export function drawMarks(plot: uPlot, marks: readonly Mark[], ink: Ink, flags: boolean): void {
  const { min, max } = plot.scales.x ?? {};
  if (min == null || max == null) return;
  const seen = within(marks, { min, max });
  plot.ctx.save();
  for (const mark of spread(plot, seen)) drawLine(plot, mark, ink);
  if (flags) drawFlags(plot, seen, ink);
  plot.ctx.restore();
}

interface Placed extends Mark {
  x: number;
}

/** At most one of a kind for each pixel: a year has thousands. */
function spread(plot: uPlot, marks: readonly Mark[]): Placed[] {
  const taken = new Map<MarkKind, number>();
  return marks.flatMap((mark) => {
    const x = Math.round(plot.valToPos(mark.time, "x", true));
    if (taken.get(mark.kind) === x) return [];
    taken.set(mark.kind, x);
    return [{ ...mark, x }];
  });
}

function drawLine({ ctx, bbox }: uPlot, { kind, x }: Placed, ink: Ink): void {
  const { dash, width } = MARK_LOOK[kind];
  ctx.strokeStyle = ink.colours[kind];
  ctx.lineWidth = width * uPlot.pxRatio;
  ctx.setLineDash(dash.map((length) => length * uPlot.pxRatio));
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
}

/** Flags fly to the right of their lines, or to the left where the chart ends. */
function drawFlags(plot: uPlot, marks: readonly Mark[], { colours, ground, font }: Ink): void {
  const { ctx, bbox } = plot;
  const pixel = uPlot.pxRatio;
  const [height, pad] = [FLAG.height * pixel, FLAG.pad * pixel];
  ctx.font = font;
  ctx.textBaseline = "middle";
  ctx.textAlign = "left";
  const placed = marks.map((mark) => {
    const x = plot.valToPos(mark.time, "x", true);
    const width = ctx.measureText(mark.flag).width + 2 * pad;
    const from = x + width > bbox.left + bbox.width ? x - width : x;
    return { ...mark, from, to: from + width };
  });
  for (const { kind, flag, from, to } of flagged(placed)) {
    ctx.fillStyle = colours[kind];
    ctx.fillRect(from, bbox.top - height, to - from, height);
    ctx.fillStyle = ground;
    ctx.fillText(flag, from + pad, bbox.top - height / 2 + pixel / 2);
  }
}
