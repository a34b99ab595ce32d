import { useMemo } from "react";
import type { Reception } from "../../api/types";
import { t } from "../../text";
import { rateColumns, total } from "./health";
import css from "./health.module.css";
import { RateChart } from "./RateChart";

/** How many samples and fixes a second came, and how much was not used, over time. */
export function Rates({ health }: { health: Reception }) {
  const columns = useMemo(() => rateColumns(health.rates), [health.rates]);
  const span = { since: Date.parse(health.since) / 1000, until: Date.parse(health.until) / 1000 };
  if (columns.time.length === 0) return null;
  return (
    <div className={css.charts}>
      <RateChart what="samples" time={columns.time} value={columns.samples} {...span} />
      <RateChart what="fixes" time={columns.time} value={columns.fixes} {...span} />
      {total(health.rejected) > 0 && (
        <RateChart what="rejected" time={columns.time} value={columns.rejected} {...span} />
      )}
      <p className={css.note}>{t("history.health.chart.about")}</p>
    </div>
  );
}
