import { useComputedColorScheme } from "@mantine/core";
import { useEffect, useRef } from "react";
import type uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { TimeAxis } from "../device/history/timeAxis";
import { fixed } from "../lib/format";
import { t } from "../text";
import { type Column, reach } from "./drive";
import type { Happening } from "./happenings";
import css from "./motion.module.css";
import { type Line, seriesPlot } from "./seriesPlot";

interface SeriesChartProps {
  title: string;
  unit: string;
  digits: number;
  leastSpan: number;
  fromZero: boolean;
  names: readonly string[];
  time: readonly number[];
  lines: readonly (Line & { column: Column })[];
  axis: TimeAxis;
  happenings: readonly Happening[];
  /** the row that the whole page tells of */
  row: number;
  onCursor: (row: number | null) => void;
  onReset: () => void;
}

/** Some quantities over time; their values at the cursor, or the last ones, stand above. */
export function SeriesChart(props: SeriesChartProps) {
  const { title, unit, digits, lines, row } = props;
  const element = usePlot(props);
  const reached = reach(...lines.map(({ column }) => column));
  const said = reached
    ? t("motion.chart_says", {
        title,
        least: fixed(reached[0], digits),
        most: fixed(reached[1], digits),
        unit,
      })
    : t("motion.chart_empty", { title });
  return (
    <figure className={css.chart}>
      <figcaption>
        <b>{title}</b> <span>{unit}</span>
        {lines.map(({ name, colour, column }) => (
          <span key={name} className={css.value} style={{ "--line": `var(${colour})` }}>
            {lines.length > 1 && name} <b>{valueText(column[row], digits)}</b>
          </span>
        ))}
      </figcaption>
      <div ref={element} role="img" aria-label={said} />
    </figure>
  );
}

function valueText(value: number | null | undefined, digits: number): string {
  return value == null ? "–" : fixed(value, digits);
}

function usePlot(props: SeriesChartProps) {
  const { time, lines, axis, happenings, leastSpan, fromZero, onCursor } = props;
  const element = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot>(null);
  const now = useRef(props);
  now.current = props;
  const scheme = useComputedColorScheme("light");
  const told = lines.map(({ name }) => name).join();

  // biome-ignore lint/correctness/useExhaustiveDependencies: made anew when its lines or the page's colours are others
  useEffect(() => {
    if (!element.current) return;
    const [made, remove] = seriesPlot({
      element: element.current,
      lines: now.current.lines,
      leastSpan,
      fromZero,
      names: now.current.names,
      time: axis,
      happenings: () => now.current.happenings,
      onCursor,
      onReset: () => now.current.onReset(),
    });
    plot.current = made;
    return remove;
  }, [axis, told, leastSpan, fromZero, scheme, onCursor]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: a chart made anew needs its data again
  useEffect(() => {
    const span = axis.chosen ?? { min: time[0] ?? 0, max: time.at(-1) ?? 1 };
    plot.current?.batch(() => {
      plot.current?.setData([[...time], ...lines.map(({ column }) => [...column])], false);
      plot.current?.setScale("x", span);
    });
  }, [axis, time, happenings, told, scheme]);

  return element;
}
