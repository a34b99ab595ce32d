/** One angle's chart. */
import type uPlot from "uplot";
import { wrap } from "../../lib/angles";
import { fixed } from "../../lib/format";
import { look, plotIn, timeTexts, withAlpha } from "../plot";

export interface PlotSettings {
  element: HTMLElement;
  /** "#rrggbb" */
  colour: string;
  /** the time axis is drawn */
  timed: boolean;
  onCursor: (row: number | null) => void;
  onZoom: (from: number, to: number) => void;
}

/** Pixels. */
const HEIGHT = { chart: 110, axis: 24 };
/** Charts with this key move their cursors together. */
const SYNC = "livella-angles";
/** Pixels; a shorter drag is a click. */
const SHORTEST_DRAG = 8;

/** Make the chart of an angle; gives it, and the function that takes it away. */
export function makePlot(settings: PlotSettings): [uPlot, () => void] {
  return plotIn(settings.element, plotOptions(settings));
}

function plotOptions({
  element,
  colour,
  timed,
  onCursor,
  onZoom,
}: PlotSettings): Omit<uPlot.Options, "width"> {
  const axisHeight = timed ? HEIGHT.axis : 0;
  const { axis } = look(element);
  const edge: uPlot.Series = { stroke: "transparent", points: { show: false } };
  return {
    height: HEIGHT.chart + axisHeight,
    legend: { show: false },
    cursor: {
      sync: { key: SYNC },
      drag: { x: true, y: false, setScale: false },
      points: { size: 7 },
      y: false,
    },
    scales: { x: { time: true } },
    padding: [6, 12, 6, 0],
    axes: [
      {
        ...axis,
        size: axisHeight,
        space: 70,
        values: (_, ticks, __, ___, step) => (timed ? timeTexts(ticks, step) : ticks.map(() => "")),
      },
      { ...axis, size: 52, space: 24, values: (_, ticks) => ticks.map(tickText) },
    ],
    series: [{}, { stroke: colour, width: 2, points: { show: false } }, edge, edge],
    bands: [{ series: [3, 2], fill: withAlpha(colour, 0.18) }],
    hooks: {
      setCursor: [(plot) => onCursor(plot.cursor.idx ?? null)],
      setSelect: [(plot) => zoom(plot, onZoom)],
    },
  };
}

/** The curve runs on beyond 180 degrees; its labels do not. */
function tickText(tick: number): string {
  const degrees = wrap(tick);
  return `${fixed(degrees, Number.isInteger(degrees) ? 0 : 1)}°`;
}

function zoom(plot: uPlot, onZoom: PlotSettings["onZoom"]): void {
  const { left, width } = plot.select;
  if (width < SHORTEST_DRAG) return;
  onZoom(plot.posToVal(left, "x"), plot.posToVal(left + width, "x"));
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
}
