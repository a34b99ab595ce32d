/** Options of one angle's chart. Colours come from the page's own variables, so that light and dark both fit. */
import uPlot from "uplot";
import { wrap } from "../../lib/angles";
import { fixed } from "../../lib/format";

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

/** Make a chart that keeps the width of its element; gives it, and the function that takes it away. */
export function makePlot(settings: PlotSettings): [uPlot, () => void] {
  const { element } = settings;
  const options = plotOptions(settings);
  const plot = new uPlot(options, [[]], element);
  const watcher = new ResizeObserver(() =>
    plot.setSize({ width: element.clientWidth, height: options.height }),
  );
  watcher.observe(element);
  return [
    plot,
    () => {
      watcher.disconnect();
      plot.destroy();
    },
  ];
}

function plotOptions({ element, colour, timed, onCursor, onZoom }: PlotSettings): uPlot.Options {
  const axisHeight = timed ? HEIGHT.axis : 0;
  const style = getComputedStyle(element);
  const line = style.getPropertyValue("--livella-line");
  const ink = style.getPropertyValue("--mantine-color-dimmed");
  const font = `12px ${style.fontFamily}`;
  const axis: uPlot.Axis = { stroke: ink, font, grid: { stroke: line, width: 1 }, ticks: { show: false } };
  const edge: uPlot.Series = { stroke: "transparent", points: { show: false } };
  return {
    width: element.clientWidth,
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

const SECONDS = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit", second: "2-digit" });
const MINUTES = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit" });
const DAYS = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short" });

/** Times as fine as the steps between them; midnight shows the date. */
function timeTexts(ticks: readonly number[], step: number): string[] {
  const usual = step < 60 ? SECONDS : step < 86_400 ? MINUTES : DAYS;
  return ticks.map((tick) => {
    const time = new Date(tick * 1000);
    const midnight = time.getHours() + time.getMinutes() + time.getSeconds() === 0;
    return (midnight ? DAYS : usual).format(time);
  });
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

/** "#rrggbb" with an alpha. */
function withAlpha(colour: string, alpha: number): string {
  const hex = Math.round(alpha * 255).toString(16);
  return `${colour.trim()}${hex.padStart(2, "0")}`;
}
