/** One angle's chart. */
import type uPlot from "uplot";
import { wrap } from "../../lib/angles";
import { fixed } from "../../lib/format";
import { tickTimes } from "../../lib/time";
import { look, plotIn, withAlpha } from "../plot";
import { drawBand, type Edges } from "./drawBand";
import { drawMarks, inkOf } from "./drawMarks";
import { listen } from "./gestures";
import type { Mark } from "./marks";
import type { TimeAxis } from "./timeAxis";

export interface PlotSettings {
  element: HTMLElement;
  /** "#rrggbb" */
  colour: string;
  time: TimeAxis;
  /** the uppermost chart has the flags of the marks, the lowest one tells the time */
  place: { first: boolean; last: boolean };
  marks: () => readonly Mark[];
  band: () => Edges;
  onCursor: (row: number | null) => void;
  onReset: () => void;
}

/** Pixels. */
const HEIGHT = { chart: 110, axis: 24, flags: 18 };
/** Charts with this key move their cursors together. */
const SYNC = "livella-angles";
/** Pixels; a shorter drag is a click. */
const SHORTEST_DRAG = 8;
/** Pixels. */
const LINE = { thick: 2, thin: 1 };

/** Make the chart of an angle; gives it, and the function that takes it away. */
export function makePlot(settings: PlotSettings): [uPlot, () => void] {
  const [plot, remove] = plotIn(settings.element, plotOptions(settings));
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

function plotOptions(settings: PlotSettings): Omit<uPlot.Options, "width"> {
  const { element, colour, time, place, onCursor } = settings;
  const axisHeight = place.last ? HEIGHT.axis : 0;
  const flags = place.first ? HEIGHT.flags : 0;
  const { axis } = look(element);
  const ink = inkOf(element);
  const soft = withAlpha(colour, 0.18);
  return {
    height: HEIGHT.chart + axisHeight + flags,
    legend: { show: false },
    cursor: cursor(settings),
    scales: { x: { time: true, auto: false }, y: { auto: false } },
    padding: [6 + flags, 12, 6, 0],
    axes: [
      {
        ...axis,
        size: axisHeight,
        space: 70,
        values: (_, ticks, __, ___, step) => (place.last ? tickTimes(ticks, step) : ticks.map(() => "")),
      },
      { ...axis, size: 52, space: 24, values: (_, ticks) => ticks.map(tickText) },
    ],
    series: [{}, { stroke: colour, width: LINE.thick, points: { show: false } }],
    hooks: {
      setCursor: [(plot) => onCursor(plot.cursor.idx ?? null)],
      setSelect: [(plot) => zoom(plot, time)],
      drawClear: [thin],
      drawAxes: [(plot) => drawBand(plot, settings.band(), soft)],
      draw: [(plot) => drawMarks(plot, settings.marks(), ink, place.first)],
    },
  };
}

/** A dense curve is drawn thin: it shows more, and thick it would take most of the time of a frame. */
function thin(plot: uPlot): void {
  const [time, angle] = plot.series;
  const [from, to] = time?.idxs ?? [0, 0];
  if (angle) angle.width = to - from > plot.over.clientWidth ? LINE.thin : LINE.thick;
}

/** A drag zooms, unless shift is held: then it moves, which `gestures.ts` does. */
function cursor({ onReset }: PlotSettings): uPlot.Cursor {
  return {
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
  };
}

/** The curve runs on beyond 180 degrees; its labels do not. */
function tickText(tick: number): string {
  const degrees = wrap(tick);
  return `${fixed(degrees, Number.isInteger(degrees) ? 0 : 1)}°`;
}

function zoom(plot: uPlot, time: TimeAxis): void {
  const { left, width } = plot.select;
  if (width < SHORTEST_DRAG) return;
  time.look({ min: plot.posToVal(left, "x"), max: plot.posToVal(left + width, "x") });
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
}
