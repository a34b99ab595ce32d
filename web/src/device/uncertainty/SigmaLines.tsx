import { useComputedColorScheme } from "@mantine/core";
import { useEffect, useRef } from "react";
import "uplot/dist/uPlot.min.css";
import type { Installation } from "../../api/types";
import { degreesText } from "../../lib/format";
import { t } from "../../text";
import { type SigmaHistory, sigmaLimits } from "./sigma";
import { type SigmaPlot, sigmaPlot } from "./sigmaPlot";
import css from "./uncertainty.module.css";

interface SigmaLinesProps {
  history: SigmaHistory;
  limits: Installation["limits"];
}

/** Three lines on a logarithmic scale that sink below the limits. */
export default function SigmaLines({ history, limits }: SigmaLinesProps) {
  const element = useRef<HTMLDivElement>(null);
  const plot = useRef<SigmaPlot>(null);
  const scheme = useComputedColorScheme("light");
  const { tilt_sigma_deg, yaw_sigma_deg } = limits;

  // biome-ignore lint/correctness/useExhaustiveDependencies: the colours are read again when the scheme changes
  useEffect(() => {
    if (!element.current) return;
    plot.current = sigmaPlot(element.current, sigmaLimits({ tilt_sigma_deg, yaw_sigma_deg }));
    return plot.current.remove;
  }, [scheme, tilt_sigma_deg, yaw_sigma_deg]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: a chart made anew needs its data again
  useEffect(() => plot.current?.show(history), [history, scheme, tilt_sigma_deg, yaw_sigma_deg]);

  const last = (axis: 0 | 1 | 2) =>
    degreesText(history.sigma[axis].findLast((value) => value !== null) ?? Number.NaN);
  const told = { roll: last(0), pitch: last(1), yaw: last(2) };
  return (
    <figure className={css.chart}>
      <figcaption>{t("device.sure.chart")}</figcaption>
      <div ref={element} role="img" aria-label={t("device.sure.chart_says", told)} />
    </figure>
  );
}
