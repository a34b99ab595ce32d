import { useComputedColorScheme } from "@mantine/core";
import { useEffect, useRef, useState } from "react";
import "uplot/dist/uPlot.min.css";
import { significant } from "../../lib/format";
import { onTheClock } from "../../lib/time";
import { t } from "../../text";
import { ends } from "./health";
import css from "./health.module.css";
import { ratePlot } from "./ratePlot";

interface RateChartProps {
  what: "samples" | "fixes" | "rejected";
  time: number[];
  value: (number | null)[];
  /** s since 1970 */
  since: number;
  until: number;
}

/** A rate over time, chunk by chunk; the value under the cursor stands above it. */
export function RateChart({ what, time, value, since, until }: RateChartProps) {
  const element = useRef<HTMLDivElement>(null);
  const [row, setRow] = useState<number | null>(null);
  const scheme = useComputedColorScheme("light");

  // biome-ignore lint/correctness/useExhaustiveDependencies: the colours are read again when the scheme changes
  useEffect(() => {
    const target = element.current;
    if (!target) return;
    return ratePlot({
      element: target,
      time,
      value,
      span: [since, until],
      bars: what === "rejected",
      onCursor: setRow,
    });
  }, [what, time, value, since, until, scheme]);

  const [least, most] = ends(value).map((end) => significant(end, 3));
  return (
    <figure className={css.chart}>
      <figcaption>
        <b>{t(`history.health.chart.${what}`)}</b> <span>{reading(time, value, row)}</span>
      </figcaption>
      <div
        ref={element}
        role="img"
        aria-label={t(`history.health.chart.${what}_over`, { least: least ?? "", most: most ?? "" })}
      />
    </figure>
  );
}

function reading(time: number[], value: (number | null)[], row: number | null): string {
  const found = row === null ? null : value[row];
  if (row === null || found === null || found === undefined) return "";
  return `${significant(found, 3)} · ${onTheClock(new Date((time[row] ?? 0) * 1000))}`;
}
