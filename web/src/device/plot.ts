/** What the page's charts have in common. Colours come from the page's own variables, so that light and dark both fit. */
import uPlot from "uplot";
import { apart } from "./apart";

/** Put a chart into an element and keep its width; gives it, and the function that takes it away. */
export function plotIn(element: HTMLElement, options: Omit<uPlot.Options, "width">): [uPlot, () => void] {
  const plot = new uPlot({ ...options, width: element.clientWidth }, [[]], element);
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

/** Ink and lettering of a chart in this element. */
export function look(element: HTMLElement): { ink: string; font: string; axis: uPlot.Axis } {
  const style = getComputedStyle(element);
  const line = style.getPropertyValue("--livella-line");
  const ink = style.getPropertyValue("--mantine-color-dimmed");
  const font = `12px ${style.fontFamily}`;
  return { ink, font, axis: { stroke: ink, font, grid: { stroke: line, width: 1 }, ticks: { show: false } } };
}

export interface LineName {
  text: string;
  colour: string;
  /** where the line ends, on the vertical scale */
  value: number;
}

/** CSS pixels between two names at least, and before them. */
const NAME = { height: 14, before: 6 };

/** CSS pixels right of the plot that names take. */
export function roomForNames(font: string, words: readonly string[]): number {
  const context = document.createElement("canvas").getContext("2d");
  if (!context) return 0;
  context.font = bold(font, 1);
  return Math.ceil(Math.max(...words.map((word) => context.measureText(word).width))) + NAME.before + 2;
}

/** The charts' lettering for what is written on the canvas itself, whose pixels are finer than the page's. */
function bold(font: string, pixel: number): string {
  return font.replace("12px", `600 ${12 * pixel}px`);
}

/** Write the names of lines where they end, right of the plot, none on another. */
export function nameLines(plot: uPlot, font: string, names: readonly LineName[]): void {
  const { ctx, bbox } = plot;
  const pixel = uPlot.pxRatio;
  const wanted = names.map(({ value }) => plot.valToPos(value, "y", true));
  const places = apart(wanted, NAME.height * pixel, bbox.top + bbox.height);
  ctx.save();
  ctx.font = bold(font, pixel);
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  names.forEach(({ text, colour }, i) => {
    ctx.fillStyle = colour;
    ctx.fillText(text, bbox.left + bbox.width + NAME.before * pixel, places[i] ?? 0);
  });
  ctx.restore();
}

/** "#rrggbb" with an alpha. */
export function withAlpha(colour: string, alpha: number): string {
  const hex = Math.round(alpha * 255).toString(16);
  return `${colour.trim()}${hex.padStart(2, "0")}`;
}
