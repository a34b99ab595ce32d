import type { Reception } from "../../api/types";
import { significant, whole } from "../../lib/format";
import { t } from "../../text";
import { total, usual } from "./health";
import css from "./health.module.css";

/** What came in, in numbers. */
export function Numbers({ health: { chunks, samples, fixes, rejected, rates } }: { health: Reception }) {
  const figures = {
    chunks: whole(chunks),
    samples: whole(samples),
    fixes: whole(fixes),
    rejected: whole(total(rejected)),
    sample_rate: hertz(usual(rates.sample_rate_hz)),
    fix_rate: hertz(usual(rates.fix_rate_hz)),
  };
  return (
    <dl className={css.figures} aria-label={t("history.health.figure.list")}>
      {(Object.keys(figures) as (keyof typeof figures)[]).map((name) => (
        <div key={name}>
          <dt>{t(`history.health.figure.${name}`)}</dt>
          <dd>{figures[name]}</dd>
        </div>
      ))}
    </dl>
  );
}

function hertz(rate: number | null): string {
  return rate === null ? t("common.unknown") : `${significant(rate, 3)} Hz`;
}
