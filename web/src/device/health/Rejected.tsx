import type { Reception } from "../../api/types";
import { significant, whole } from "../../lib/format";
import { t } from "../../text";
import { reasons } from "./health";
import css from "./health.module.css";

const KNOWN = [
  "duplicate_time",
  "before_previous_sample",
  "fix_without_velocity",
  "fix_implausible",
  "fix_repeated",
  "unusable",
] as const;

/** What was not used, and what the maker or installer can do about it. */
export function Rejected({ health }: { health: Reception }) {
  const found = reasons(health);
  if (found.length === 0) return null;
  return (
    <div>
      <h3 className={css.title}>{t("history.health.rejected.title")}</h3>
      <ul className={css.list}>
        {found.map(({ reason, number, percent }) => (
          <li key={reason}>
            <b>{words(reason).what}</b>
            <span>
              {t("history.health.rejected.share", {
                number: whole(number),
                percent: significant(percent, 2),
              })}
            </span>
            <p>{words(reason).remedy}</p>
          </li>
        ))}
      </ul>
    </div>
  );
}

function words(reason: string): { what: string; remedy: string } {
  const known = KNOWN.find((name) => name === reason);
  if (!known) return { what: reason, remedy: t("history.health.rejected.other_do") };
  return {
    what: t(`history.health.rejected.${known}`),
    remedy: t(`history.health.rejected.${known}_do`),
  };
}
