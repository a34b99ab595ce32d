import { useComputedColorScheme } from "@mantine/core";
import { useEffect, useRef, useState } from "react";
import type uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { wrap } from "../../lib/angles";
import { fixed } from "../../lib/format";
import { onTheClock } from "../../lib/time";
import { type Angle, type AngleHistory, verticalRange } from "./history";
import css from "./history.module.css";
import { makePlot } from "./plot";

const WORD: Record<Angle, { word: string; axis: "x" | "y" | "z" }> = {
  roll: { word: "Roll", axis: "x" },
  pitch: { word: "Pitch", axis: "y" },
  yaw: { word: "Yaw", axis: "z" },
};

interface AngleChartProps {
  angle: Angle;
  history: AngleHistory;
  onZoom: (from: number, to: number) => void;
  /** the lowest chart tells the time */
  lowest: boolean;
}

/** One angle over time with its band of one sigma; the value under the cursor, or the last one, stands above it. */
export function AngleChart({ angle, history, onZoom, lowest }: AngleChartProps) {
  const [row, setRow] = useState<number | null>(null);
  const element = usePlot({ angle, history, onZoom, lowest }, setRow);
  const text = reading(history, angle, row);
  const { word, axis } = WORD[angle];
  return (
    <figure className={css.chart} style={{ "--angle": `var(--livella-${axis})` }}>
      <figcaption>
        <i aria-hidden /> <b>{word}</b> {text.value} <span>{text.when}</span>
      </figcaption>
      <div
        ref={element}
        role="img"
        aria-label={`${word} over time; last: ${reading(history, angle, null).value}`}
      />
    </figure>
  );
}

function usePlot(
  { angle, history, onZoom, lowest }: AngleChartProps,
  onCursor: (row: number | null) => void,
) {
  const element = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot>(null);
  const handlers = useRef({ onCursor, onZoom });
  handlers.current = { onCursor, onZoom };
  const scheme = useComputedColorScheme("light");

  // biome-ignore lint/correctness/useExhaustiveDependencies: the colours are read again when the scheme changes
  useEffect(() => {
    const target = element.current;
    if (!target) return;
    const [made, remove] = makePlot({
      element: target,
      colour: getComputedStyle(target).getPropertyValue(`--livella-${WORD[angle].axis}`),
      timed: lowest,
      onCursor: (found) => handlers.current.onCursor(found),
      onZoom: (from, to) => handlers.current.onZoom(from, to),
    });
    plot.current = made;
    return remove;
  }, [angle, lowest, scheme]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: a chart made anew needs its data again
  useEffect(() => {
    const { value, low, high } = history.angles[angle];
    const [min, max] = verticalRange(history, angle);
    plot.current?.batch(() => {
      plot.current?.setData([history.time, value, low, high]);
      plot.current?.setScale("y", { min, max });
    });
  }, [angle, history, lowest, scheme]);

  return element;
}

function reading(history: AngleHistory, angle: Angle, row: number | null): { value: string; when: string } {
  const { value, high } = history.angles[angle];
  const at = row !== null && value[row] != null ? row : value.findLastIndex((v) => v !== null);
  const v = value[at];
  if (v === null || v === undefined) return { value: "–", when: "" };
  const when = row === at ? onTheClock(new Date((history.time[at] ?? 0) * 1000)) : "";
  return { value: `${fixed(wrap(v), 1)}° ± ${((high[at] ?? v) - v).toFixed(1)}°`, when };
}
