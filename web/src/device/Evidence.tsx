import { Suspense, useMemo, useState } from "react";
import type { Alert } from "../api/types";
import { optional } from "../components/optional";
import { t } from "../text";
import { type AlertData, evidenceSeries } from "./evidence";
import css from "./evidence.module.css";
import { evidenceRows } from "./evidenceRows";
import fold from "./fold.module.css";

const EvidenceChart = optional(() => import("./EvidenceChart"));

interface EvidenceProps {
  kind: Alert["kind"];
  data: AlertData;
  unfolded: boolean;
}

/** What is behind an alert: the chart a test decided on, and the numbers, folded away once it is over. */
export function Evidence({ kind, data, unfolded }: EvidenceProps) {
  const series = useMemo(() => evidenceSeries(data), [data]);
  const [open, setOpen] = useState(unfolded && series !== null);
  const rows = evidenceRows(data, kind);
  if (rows.length === 0) return null;
  return (
    <details className={css.evidence} open={open} onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary className={fold.line}>{t("history.evidence.title")}</summary>
      {open && series && (
        <Suspense fallback={<div className={css.coming} />}>
          <EvidenceChart series={series} />
        </Suspense>
      )}
      <dl>
        {rows.map(({ name, label, text }) => (
          <div key={name}>
            <dt>{label}</dt>
            <dd>{text}</dd>
          </div>
        ))}
      </dl>
    </details>
  );
}
