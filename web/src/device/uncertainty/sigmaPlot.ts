/** The chart of the three sigmas. */
import uPlot from "uplot";
import { fixed } from "../../lib/format";
import { tickTimes } from "../../lib/time";
import { t } from "../../text";
import { look, nameLines, plotIn, roomForNames } from "../plot";
import { type SigmaHistory, sigmaRange } from "./sigma";

/** Pixels. */
const HEIGHT = 170;
/** Each line has its own colour and its own stroke. */
const LINES = [
  { colour: "--livella-x", dash: [] },
  { colour: "--livella-y", dash: [7, 4] },
  { colour: "--livella-z", dash: [2, 3] },
];
const LIMIT_DASH = [4, 4];
/** Degrees; a tick at each. */
const TICKS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];

export interface SigmaPlot {
  show: (history: SigmaHistory) => void;
  remove: () => void;
}

/** Put the chart into an element. */
export function sigmaPlot(element: HTMLElement, limits: readonly number[]): SigmaPlot {
  const range: { now: [number, number] } = { now: [0.1, 20] };
  const [plot, remove] = plotIn(
    element,
    options(element, limits, () => range.now),
  );
  const show = (history: SigmaHistory) => {
    range.now = sigmaRange(history, limits);
    plot.setData([history.time, ...history.sigma]);
  };
  return { show, remove };
}

function options(
  element: HTMLElement,
  limits: readonly number[],
  range: () => [number, number],
): Omit<uPlot.Options, "width"> {
  const { axis, font } = look(element);
  const style = getComputedStyle(element);
  return {
    height: HEIGHT,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: true }, y: { distr: 3, range } },
    padding: [8, roomForNames(font, words()), 0, 0],
    axes: [
      { ...axis, size: 24, space: 64, values: (_, ticks, __, ___, step) => tickTimes(ticks, step) },
      {
        ...axis,
        size: 46,
        splits: (_, __, least, most) => TICKS.filter((tick) => tick >= least && tick <= most),
        filter: (_, ticks) => ticks,
        values: (_, ticks) => ticks.map((tick) => `${fixed(tick, tick < 1 ? 1 : 0)}°`),
      },
    ],
    series: [
      {},
      ...LINES.map(({ colour, dash }) => ({
        stroke: style.getPropertyValue(colour),
        width: 2,
        dash,
        points: { show: false },
      })),
    ],
    hooks: { draw: [(plot) => label(plot, element), (plot) => drawLimits(plot, element, limits)] },
  };
}

const words = () => [t("common.roll"), t("common.pitch"), t("common.yaw")];

function label(plot: uPlot, element: HTMLElement): void {
  const style = getComputedStyle(element);
  const names = LINES.flatMap(({ colour }, i) => {
    const value = Array.from(plot.data[i + 1] ?? []).findLast((sigma) => sigma !== null);
    const text = words()[i] ?? "";
    return value ? [{ text, colour: style.getPropertyValue(colour), value }] : [];
  });
  nameLines(plot, look(element).font, names);
}

/** Those that differ by less than a name's height have one name. */
function drawLimits(plot: uPlot, element: HTMLElement, limits: readonly number[]): void {
  const { ctx, bbox } = plot;
  const { ink, font } = look(element);
  const pixel = uPlot.pxRatio;
  ctx.save();
  ctx.strokeStyle = ink;
  ctx.fillStyle = ink;
  ctx.lineWidth = pixel;
  ctx.setLineDash(LIMIT_DASH.map((length) => length * pixel));
  for (const limit of new Set(limits)) {
    const y = plot.valToPos(limit, "y", true);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
  }
  ctx.font = font.replace("12px", `${12 * pixel}px`);
  ctx.textAlign = "left";
  ctx.textBaseline = "top";
  const lowest = plot.valToPos(Math.min(...limits), "y", true);
  ctx.fillText(t("device.sure.limit"), bbox.left + 4 * pixel, lowest + 3 * pixel);
  ctx.restore();
}
