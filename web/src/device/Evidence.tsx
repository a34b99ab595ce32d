import css from "./device.module.css";
import { labelled, shortened } from "./evidence";

/** The numbers behind an alert, folded away. */
export function Evidence({ data }: { data: Readonly<Record<string, unknown>> }) {
  const rows = Object.entries(data).filter(([, value]) => value !== null);
  if (rows.length === 0) return null;
  return (
    <details className={css.evidence}>
      <summary>Evidence</summary>
      <dl>
        {rows.map(([name, value]) => {
          const { label, unit } = labelled(name);
          return (
            <div key={name}>
              <dt>{label}</dt>
              <dd>
                {shortened(value)}
                {unit}
              </dd>
            </div>
          );
        })}
      </dl>
    </details>
  );
}
