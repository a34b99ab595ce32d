import { useMemo, useState } from "react";
import css from "./device.module.css";
import { EvidenceChart } from "./EvidenceChart";
import { type AlertData, evidenceRows, evidenceSeries } from "./evidence";

/** What is behind an alert: the chart a test decided on, and the numbers, folded away once it is over. */
export function Evidence({ data, unfolded }: { data: AlertData; unfolded: boolean }) {
  const series = useMemo(() => evidenceSeries(data), [data]);
  const [open, setOpen] = useState(unfolded && series !== null);
  const rows = evidenceRows(data);
  if (rows.length === 0) return null;
  return (
    <details className={css.evidence} open={open} onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>Evidence</summary>
      {open && series && <EvidenceChart series={series} />}
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
