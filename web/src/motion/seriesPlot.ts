/** One chart over time: a few lines, the marks of what happened, and a cursor that all charts of the page share. */
import type uPlot from "uplot";
import { listen } from "../device/history/gestures";
import type { TimeAxis } from "../device/history/timeAxis";
import { look, nameLines, plotIn, roomForNames } from "../device/plot";
import { fixed } from "../lib/format";
import { tickTimes } from "../lib/time";
import type { Happening } from "./happenings";

export interface Line {
  name: string;
  /** variable of the page */
  colour: string;
  dash: readonly number[];
}

export interface SeriesSettings {
  element: HTMLElement;
  lines: readonly Line[];
  /** the axis never spans less */
  leastSpan: number;
  fromZero: boolean;
  /** names of lines in all charts that stand below one another: they begin and end together */
  names: readonly string[];
  time: TimeAxis;
  happenings: () => readonly Happening[];
  onCursor: (row: number | null) => void;
  onReset: () => void;
}

/** Pixels. */
const HEIGHT = 150;
const SYNC = "livella-motion";
/** Pixels; a shorter drag is a click. */
const SHORTEST_DRAG = 8;
/** Pixels on and off. */
const DASH = [3, 3];

/** Put the chart into an element; gives it, and the function that takes it away. */
export function seriesPlot(settings: SeriesSettings): [uPlot, () => void] {
  const [plot, remove] = plotIn(settings.element, options(settings));
  const leave = settings.time.add(plot);
  const deaf = listen(plot, settings.time);
  return [
    plot,
    () => {
      deaf();
      leave();
      remove();
    },
  ];
}

function options({
  element,
  lines,
  leastSpan,
  fromZero,
  names,
  time,
  happenings,
  onCursor,
  onReset,
}: SeriesSettings): Omit<uPlot.Options, "width"> {
  const { axis, font } = look(element);
  const style = getComputedStyle(element);
  const drawn = lines.map((line) => ({ ...line, ink: style.getPropertyValue(line.colour) }));
  const [ink, bad] = [
    style.getPropertyValue("--mantine-color-dimmed"),
    style.getPropertyValue("--livella-bad"),
  ];
  return {
    height: HEIGHT,
    legend: { show: false },
    cursor: {
      sync: { key: SYNC },
      drag: { x: true, y: false, setScale: false },
      points: { size: 7 },
      y: false,
      bind: {
        mousedown: (_, __, begin) => (event) => {
          if (!event.shiftKey) begin(event);
          return null;
        },
        dblclick: () => () => {
          onReset();
          return null;
        },
      },
    },
    scales: {
      x: { time: true, auto: false },
      y: { range: (_, low, high) => rangeFor(low, high, leastSpan, fromZero) },
    },
    padding: [8, roomForNames(font, names), 0, 0],
    axes: [
      { ...axis, size: 24, space: 70, values: (_, ticks, __, ___, step) => tickTimes(ticks, step) },
      {
        ...axis,
        size: 46,
        space: 28,
        values: (_, ticks, __, ___, step) => ticks.map((tick) => tickText(tick, step)),
      },
    ],
    series: [
      {},
      ...drawn.map(({ ink, dash }) => ({
        stroke: ink,
        width: 1.5,
        dash: [...dash],
        points: { show: false },
      })),
    ],
    hooks: {
      setCursor: [(plot) => onCursor(plot.cursor.idx ?? null)],
      setSelect: [(plot) => zoom(plot, time)],
      drawAxes: [(plot) => mark(plot, happenings(), { usual: ink, grave: bad })],
      draw: [
        (plot) =>
          drawn.length > 1 &&
          nameLines(
            plot,
            font,
            drawn.map(({ name, ink }, i) => ({ text: name, colour: ink, value: lastSeen(plot, i + 1) })),
          ),
      ],
    },
  };
}

/** At least so high, and a little air above and below. */
export function rangeFor(
  low: number | null,
  high: number | null,
  least: number,
  fromZero: boolean,
): [number, number] {
  if (fromZero) return [Math.min(0, low ?? 0), Math.max(least, 1.06 * (high ?? 0))];
  if (low === null || high === null) return [-least / 2, least / 2];
  const room = Math.max(least - (high - low), 0.12 * (high - low)) / 2;
  return [low - room, high + room];
}

function tickText(tick: number, step: number): string {
  return fixed(tick, step >= 1 ? 0 : step >= 0.1 ? 1 : 2);
}

/** Where a line leaves what is seen. */
function lastSeen(plot: uPlot, series: number): number {
  const column = plot.data[series] ?? [];
  for (let row = plot.series[0]?.idxs?.[1] ?? column.length - 1; row >= 0; row -= 1) {
    const value = column[row];
    if (value != null) return value;
  }
  return 0;
}

/** A line for each event in view; an impact's is drawn through and thicker. */
function mark(
  plot: uPlot,
  happenings: readonly Happening[],
  colours: Record<"usual" | "grave", string>,
): void {
  const { min = 0, max = 0 } = plot.scales.x as { min?: number; max?: number };
  const { ctx, bbox } = plot;
  ctx.save();
  for (const { time, grave } of happenings.filter(({ time }) => time >= min && time <= max)) {
    const x = plot.valToPos(time, "x", true);
    ctx.strokeStyle = colours[grave ? "grave" : "usual"];
    ctx.lineWidth = (grave ? 2 : 1) * devicePixelRatio;
    ctx.setLineDash(grave ? [] : DASH.map((length) => length * devicePixelRatio));
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
  }
  ctx.restore();
}

function zoom(plot: uPlot, time: TimeAxis): void {
  const { left, width } = plot.select;
  if (width < SHORTEST_DRAG) return;
  time.look({ min: plot.posToVal(left, "x"), max: plot.posToVal(left + width, "x") });
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
}
