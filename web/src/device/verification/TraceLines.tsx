import { useComputedColorScheme } from "@mantine/core";
import { useEffect, useRef } from "react";
import "uplot/dist/uPlot.min.css";
import { t } from "../../text";
import { type Speeds, speedsSay } from "./trace";
import { type TracePlot, tracePlot } from "./tracePlot";
import css from "./verification.module.css";

/** The speed of the GPS and the one that follows from the sensor: where they part, the mounting is wrong. */
export default function TraceLines({ speeds }: { speeds: Speeds }) {
  const element = useRef<HTMLDivElement>(null);
  const plot = useRef<TracePlot>(null);
  const scheme = useComputedColorScheme("light");

  // biome-ignore lint/correctness/useExhaustiveDependencies: the colours are read again when the scheme changes
  useEffect(() => {
    if (!element.current) return;
    plot.current = tracePlot(element.current);
    return plot.current.remove;
  }, [scheme]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: a chart made anew needs its data again
  useEffect(() => plot.current?.show(speeds), [speeds, scheme]);

  return (
    <figure className={css.chart}>
      <figcaption>{t("device.test.axis")}</figcaption>
      <div ref={element} role="img" aria-label={speedsSay(speeds)} />
    </figure>
  );
}
