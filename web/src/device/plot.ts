/** What the page's charts have in common. Colours come from the page's own variables, so that light and dark both fit. */
import uPlot from "uplot";

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

const SECONDS = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit", second: "2-digit" });
const MINUTES = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit" });
const DAYS = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short" });

/** Times (s since 1970) as fine as the steps between them; midnight shows the date. */
export function timeTexts(ticks: readonly number[], step: number): string[] {
  const usual = step < 60 ? SECONDS : step < 86_400 ? MINUTES : DAYS;
  return ticks.map((tick) => {
    const time = new Date(tick * 1000);
    const midnight = time.getHours() + time.getMinutes() + time.getSeconds() === 0;
    return (midnight ? DAYS : usual).format(time);
  });
}

/** "#rrggbb" with an alpha. */
export function withAlpha(colour: string, alpha: number): string {
  const hex = Math.round(alpha * 255).toString(16);
  return `${colour.trim()}${hex.padStart(2, "0")}`;
}
