import { useComputedColorScheme } from "@mantine/core";
import { useEffect, useRef } from "react";
import "uplot/dist/uPlot.min.css";
import { t } from "../text";
import { type EvidenceSeries, evidenceText } from "./evidence";
import css from "./evidence.module.css";
import { evidencePlot } from "./evidencePlot";

/** The statistic of a sequential test over time, and the value at which it decides. */
export default function EvidenceChart({ series }: { series: EvidenceSeries }) {
  const element = useRef<HTMLDivElement>(null);
  const scheme = useComputedColorScheme("light");

  // biome-ignore lint/correctness/useExhaustiveDependencies: the colours are read again when the scheme changes
  useEffect(() => (element.current ? evidencePlot(element.current, series) : undefined), [series, scheme]);

  return (
    <figure className={css.chart}>
      <figcaption>{t("history.evidence.chart")}</figcaption>
      <div ref={element} role="img" aria-label={evidenceText(series)} />
    </figure>
  );
}
