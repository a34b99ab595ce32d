import type { Reception } from "../../api/types";
import { ClockTime } from "../../components/RelativeTime";
import { whole } from "../../lib/format";
import { Trans, t } from "../../text";
import { MOST_LOST } from "./health";
import css from "./health.module.css";

/** Chunks that never came, gap by gap. */
export function Lost({ health: { lost } }: { health: Reception }) {
  if (lost.length === 0) return null;
  return (
    <div>
      <h3 className={css.title}>{t("history.health.lost.title")}</h3>
      <p className={css.quiet}>{t("history.health.lost.do")}</p>
      <ul className={css.list}>
        {lost.map(({ session, from_seq, to_seq, before }) => (
          <li key={`${session} ${from_seq}`}>
            <b>
              {t(`history.health.lost.${from_seq === to_seq ? "one" : "some"}`, {
                name: session,
                first: whole(from_seq),
                last: whole(to_seq),
              })}
            </b>
            <span>
              <Trans i18nKey="history.health.lost.before" components={{ when: <ClockTime at={before} /> }} />
            </span>
          </li>
        ))}
      </ul>
      {lost.length >= MOST_LOST && (
        <p className={css.note}>{t("history.health.lost.most", { number: whole(MOST_LOST) })}</p>
      )}
    </div>
  );
}
