import { useComputedColorScheme } from "@mantine/core";
import { memo, useEffect, useRef, useState } from "react";
import type uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { wrap } from "../../lib/angles";
import { degreesText, fixed } from "../../lib/format";
import { onTheClock } from "../../lib/time";
import { t } from "../../text";
import { type Angle, type AngleHistory, extentOf, toldRow, verticalRange } from "./history";
import css from "./history.module.css";
import type { Mark } from "./marks";
import { makePlot } from "./plot";
import type { Span } from "./span";
import type { TimeAxis } from "./timeAxis";

const AXIS: Record<Angle, "x" | "y" | "z"> = { roll: "x", pitch: "y", yaw: "z" };

interface AngleChartProps {
  angle: Angle;
  history: AngleHistory;
  marks: readonly Mark[];
  time: TimeAxis;
  /** where the time axis rests; null: all that is loaded is shown */
  view: Span | null;
  first: boolean;
  last: boolean;
  onReset: () => void;
}

/** One angle over time with its band of one sigma; the value under the cursor, or the last one, stands above it. */
export function AngleChart(props: AngleChartProps) {
  const { angle, history, view } = props;
  const [row, setRow] = useState<number | null>(null);
  const shown = reading(history, angle, row, view);
  return (
    <figure className={css.chart} style={{ "--angle": `var(--livella-${AXIS[angle]})` }}>
      <figcaption>
        <i aria-hidden /> <b>{t(`common.${angle}`)}</b> {shown.value} <span>{shown.when}</span>
      </figcaption>
      <Plot {...props} onCursor={setRow} />
    </figure>
  );
}

interface PlotProps extends AngleChartProps {
  onCursor: (row: number | null) => void;
}

/** The chart itself, left alone while only the cursor moves. */
const Plot = memo(function Plot(props: PlotProps) {
  const { angle, history, view } = props;
  const element = usePlot(props);
  const { value } = reading(history, angle, null, view);
  return (
    <div
      ref={element}
      role="img"
      aria-label={t("history.over_time", { angle: t(`common.${angle}`), value })}
    />
  );
});

function usePlot({ angle, history, marks, time, view, first, last, onReset, onCursor }: PlotProps) {
  const element = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot>(null);
  const band = history.angles[angle];
  const now = useRef({ marks, band, onReset });
  now.current = { marks, band, onReset };
  const scheme = useComputedColorScheme("light");

  // biome-ignore lint/correctness/useExhaustiveDependencies: the colours are read again when the scheme changes
  useEffect(() => {
    const target = element.current;
    if (!target) return;
    const [made, remove] = makePlot({
      element: target,
      colour: getComputedStyle(target).getPropertyValue(`--livella-${AXIS[angle]}`),
      time,
      place: { first, last },
      marks: () => now.current.marks,
      band: () => now.current.band,
      onCursor,
      onReset: () => now.current.onReset(),
    });
    plot.current = made;
    return remove;
  }, [angle, time, first, last, scheme]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: a chart made anew needs its data again
  useEffect(() => {
    const [min, max] = verticalRange(history, angle, view);
    const span = time.chosen ?? extentOf(history);
    plot.current?.batch(() => {
      plot.current?.setData([history.time, history.angles[angle].value], false);
      if (span) plot.current?.setScale("x", span);
      plot.current?.setScale("y", { min, max });
    });
  }, [angle, history, marks, view, time, first, last, scheme]);

  return element;
}

function reading(
  history: AngleHistory,
  angle: Angle,
  cursor: number | null,
  view: Span | null,
): { value: string; when: string } {
  const { value, high } = history.angles[angle];
  const row = toldRow(history, angle, cursor, view);
  const v = value[row];
  if (v === null || v === undefined) return { value: t("common.unknown"), when: "" };
  const sigma = degreesText((high[row] ?? v) - v);
  return {
    value: t("history.value", { degrees: `${fixed(wrap(v), 1)}°`, sigma }),
    when: row === cursor ? onTheClock(new Date((history.time[row] ?? 0) * 1000)) : "",
  };
}
