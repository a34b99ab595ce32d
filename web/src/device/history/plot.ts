/** Options of one angle's chart. Colours come from the page's own variables, so that light and dark both fit. */
import type uPlot from "uplot";
import { wrap } from "../../lib/angles";

export interface PlotSettings {
  element: HTMLElement;
  colour: string;
  height: number;
  onCursor: (row: number | null) => void;
  onZoom: (from: number, to: number) => void;
}

/** Charts with this key move their cursors together. */
const SYNC = "livella-angles";
/** Pixels; a shorter drag is a click. */
const SHORTEST_DRAG = 8;

export function plotOptions(settings: PlotSettings): uPlot.Options {
  const { element, colour, height, onCursor, onZoom } = settings;
  const style = getComputedStyle(element);
  const line = style.getPropertyValue("--livella-line");
  const ink = style.getPropertyValue("--mantine-color-dimmed");
  const font = `12px ${style.fontFamily}`;
  const axis: uPlot.Axis = { stroke: ink, font, grid: { stroke: line, width: 1 }, ticks: { show: false } };
  const edge: uPlot.Series = { stroke: "transparent", points: { show: false } };
  return {
    width: element.clientWidth,
    height,
    legend: { show: false },
    cursor: {
      sync: { key: SYNC },
      drag: { x: true, y: false, setScale: false },
      points: { size: 7 },
      y: false,
    },
    scales: { x: { time: true } },
    axes: [axis, { ...axis, size: 52, space: 28, values: (_, ticks) => ticks.map(tickText) }],
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
  return `${Number(wrap(tick).toFixed(1))}°`;
}

function zoom(plot: uPlot, onZoom: PlotSettings["onZoom"]): void {
  const { left, width } = plot.select;
  if (width < SHORTEST_DRAG) return;
  onZoom(plot.posToVal(left, "x"), plot.posToVal(left + width, "x"));
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
}

/** "#rrggbb" with an alpha. */
function withAlpha(colour: string, alpha: number): string {
  const hex = Math.round(alpha * 255).toString(16);
  return `${colour.trim()}${hex.padStart(2, "0")}`;
}
