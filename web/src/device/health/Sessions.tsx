import type { Reception } from "../../api/types";
import { Copyable } from "../../components/Copyable";
import { ClockTime } from "../../components/RelativeTime";
import { whole } from "../../lib/format";
import { t } from "../../text";
import fold from "../fold.module.css";
import { MOST_SESSIONS } from "./health";
import css from "./health.module.css";

type Session = Reception["sessions"][number];

/** Power-up by power-up what came in; folded, since only engineers ask for it. */
export function Sessions({ health: { sessions } }: { health: Reception }) {
  if (sessions.length === 0) return null;
  return (
    <details>
      <summary className={fold.line}>
        {t("history.health.sessions.title")} ({whole(sessions.length)})
      </summary>
      <ul className={css.list}>
        {sessions.map((session) => (
          <li key={session.session}>
            <SessionRow session={session} />
          </li>
        ))}
      </ul>
      {sessions.length >= MOST_SESSIONS && (
        <p className={css.note}>{t("history.health.sessions.most", { number: whole(MOST_SESSIONS) })}</p>
      )}
    </details>
  );
}

function SessionRow({ session }: { session: Session }) {
  const { started_at, first_seq, last_seq, chunks, samples, fixes } = session;
  const counts = { chunks: whole(chunks), samples: whole(samples), fixes: whole(fixes) };
  return (
    <>
      <b>{started_at ? <ClockTime at={started_at} /> : t("history.health.sessions.unknown_start")}</b>
      <span>{t("history.health.sessions.numbers", { first: whole(first_seq), last: whole(last_seq) })}</span>
      <p>{t(chunks === 1 ? "history.health.sessions.line_one" : "history.health.sessions.line", counts)}</p>
      <Copyable label={t("history.health.sessions.name")} text={session.session} />
    </>
  );
}
