/** The chart of the two speeds. */
import type uPlot from "uplot";
import { fixed } from "../../lib/format";
import { t } from "../../text";
import { look, nameLines, plotIn, roomForNames } from "../plot";
import type { Speeds } from "./trace";

/** Pixels. */
const HEIGHT = 180;
/** km/h; the axis never spans less. */
const LEAST_SPAN = 10;
const LINES = [
  { colour: "--livella-accent", dash: [] },
  { colour: "--livella-warn", dash: [6, 4] },
];

export interface TracePlot {
  show: (speeds: Speeds) => void;
  remove: () => void;
}

/** Put the chart into an element. */
export function tracePlot(element: HTMLElement): TracePlot {
  const [plot, remove] = plotIn(element, options(element));
  return { show: ({ time, gps, sensor }) => plot.setData([time, gps, sensor]), remove };
}

function options(element: HTMLElement): Omit<uPlot.Options, "width"> {
  const { axis, font } = look(element);
  const style = getComputedStyle(element);
  return {
    height: HEIGHT,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: false }, y: { range: (_, least, most) => speedRange(least, most) } },
    padding: [8, roomForNames(font, words()), 0, 0],
    axes: [
      { ...axis, size: 24, space: 48, values: (_, ticks) => ticks.map((tick) => `${fixed(tick, 0)} s`) },
      { ...axis, size: 46, space: 30, values: (_, ticks) => ticks.map((tick) => fixed(tick, 0)) },
    ],
    series: [
      {},
      ...LINES.map(({ colour, dash }) => ({
        stroke: style.getPropertyValue(colour),
        width: 2.5,
        dash,
        points: { show: false },
      })),
    ],
    hooks: { draw: [(plot) => label(plot, element)] },
  };
}

/** From standstill, so that a small difference looks small. */
export function speedRange(least: number, most: number): [number, number] {
  return [Math.min(0, Math.floor(least)), Math.max(LEAST_SPAN, 1.08 * most)];
}

const words = () => [t("device.test.gps"), t("device.test.sensor")];

function label(plot: uPlot, element: HTMLElement): void {
  const style = getComputedStyle(element);
  const names = LINES.map(({ colour }, i) => ({
    text: words()[i] ?? "",
    colour: style.getPropertyValue(colour),
    value: plot.data[i + 1]?.at(-1) ?? 0,
  }));
  nameLines(plot, look(element).font, names);
}
