/** The chart of what a sequential test decided on. */
import uPlot from "uplot";
import { significant } from "../lib/format";
import { tickTimes } from "../lib/time";
import { t } from "../text";
import { type EvidenceSeries, evidenceRange, shortened } from "./evidence";
import { look, plotIn, withAlpha } from "./plot";

/** Pixels. */
const HEIGHT = 150;
const DASH = [5, 4];
/** Up to so many looks are shown as points too. */
const FEW = 40;

/** Put the chart into an element; gives the function that takes it away. */
export function evidencePlot(element: HTMLElement, series: EvidenceSeries): () => void {
  const [plot, remove] = plotIn(element, options(element, series));
  const { time, value, threshold } = series;
  plot.setData([time, value, value.map(() => threshold)]);
  return remove;
}

function options(element: HTMLElement, series: EvidenceSeries): Omit<uPlot.Options, "width"> {
  const { axis } = look(element);
  const colour = getComputedStyle(element).getPropertyValue("--livella-accent");
  const limit = getComputedStyle(element).getPropertyValue("--livella-bad");
  const few = series.value.length <= FEW;
  return {
    height: HEIGHT,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: true }, y: { range: evidenceRange(series) } },
    padding: [6, 28, 0, 0],
    axes: [
      { ...axis, size: 24, space: 70, values: (_, ticks, __, ___, step) => tickTimes(ticks, step) },
      { ...axis, size: 44, space: 28, values: (_, ticks) => ticks.map((tick) => significant(tick, 4)) },
    ],
    series: [
      {},
      {
        stroke: colour,
        width: 2,
        fill: withAlpha(colour, 0.14),
        points: { show: few, size: 5, fill: colour },
      },
      { stroke: limit, width: 1.5, dash: DASH, points: { show: false } },
    ],
    hooks: { draw: [(plot) => label(plot, element, series, limit)] },
  };
}

/** Name the threshold above its line, and mark when it began. */
function label(plot: uPlot, element: HTMLElement, { threshold, since }: EvidenceSeries, limit: string): void {
  const { ctx, bbox } = plot;
  const { ink, font } = look(element);
  const pixel = uPlot.pxRatio;
  ctx.save();
  ctx.font = font.replace("12px", `${12 * pixel}px`);
  ctx.textAlign = "left";
  ctx.textBaseline = "bottom";
  ctx.fillStyle = limit;
  const y = plot.valToPos(threshold, "y", true) - 3 * pixel;
  ctx.fillText(t("history.evidence.decides", { threshold: shortened(threshold) }), bbox.left + 4 * pixel, y);
  if (since !== null) mark(plot, plot.valToPos(since, "x", true), ink, pixel);
  ctx.restore();
}

function mark({ ctx, bbox }: uPlot, x: number, ink: string, pixel: number): void {
  if (x < bbox.left || x > bbox.left + bbox.width) return;
  ctx.strokeStyle = ink;
  ctx.fillStyle = ink;
  ctx.lineWidth = pixel;
  ctx.setLineDash(DASH.map((length) => length * pixel));
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  const late = x > bbox.left + bbox.width / 2;
  ctx.textAlign = late ? "right" : "left";
  ctx.fillText(t("history.evidence.began"), x + (late ? -4 : 4) * pixel, bbox.top + bbox.height - 4 * pixel);
}
