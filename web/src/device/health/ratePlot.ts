/** The chart of a rate over time. */
import uPlot from "uplot";
import { significant } from "../../lib/format";
import { tickTimes } from "../../lib/time";
import { look, plotIn, withAlpha } from "../plot";

export interface RatePlot {
  element: HTMLElement;
  /** s since 1970, ascending */
  time: number[];
  value: (number | null)[];
  /** what the chart is about, also where there are no data */
  span: [number, number];
  /** a count for each chunk: drawn as bars */
  bars: boolean;
  onCursor: (row: number | null) => void;
}

/** Pixels. */
const HEIGHT = 110;
/** Up to so many chunks are shown as points too. */
const FEW = 60;
/** Charts with this key move their cursors together. */
const SYNC = "livella-health";

/** Put the chart into an element; gives the function that takes it away. */
export function ratePlot(settings: RatePlot): () => void {
  const [plot, remove] = plotIn(settings.element, options(settings));
  plot.setData([settings.time, settings.value]);
  return remove;
}

function options({ element, value, span, bars, onCursor }: RatePlot): Omit<uPlot.Options, "width"> {
  const { axis } = look(element);
  const colour = getComputedStyle(element).getPropertyValue(bars ? "--livella-warn" : "--livella-accent");
  const few = value.length <= FEW;
  return {
    height: HEIGHT,
    legend: { show: false },
    cursor: {
      sync: { key: SYNC },
      drag: { x: false, y: false },
      points: { size: 7 },
      y: false,
      bind: { dblclick: () => () => null },
    },
    scales: { x: { time: true, range: span }, y: { range: (_, __, most) => [0, 1.1 * (most || 1)] } },
    padding: [6, 28, 0, 0],
    axes: [
      { ...axis, size: 24, space: 70, values: (_, ticks, __, ___, step) => tickTimes(ticks, step) },
      { ...axis, size: 52, space: 24, values: (_, ticks) => ticks.map((tick) => significant(tick, 4)) },
    ],
    series: [
      {},
      {
        stroke: colour,
        width: bars ? 1 : 2,
        fill: withAlpha(colour, bars ? 0.6 : 0.1),
        points: { show: few && !bars, size: 5, fill: colour },
        ...(bars && uPlot.paths.bars && { paths: uPlot.paths.bars({ size: [0.7, 24, 2] }) }),
      },
    ],
    hooks: { setCursor: [(plot) => onCursor(plot.cursor.idx ?? null)] },
  };
}
