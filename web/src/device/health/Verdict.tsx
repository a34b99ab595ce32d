import { CircleCheckBig, Hourglass, PackageX } from "lucide-react";
import type { Reception } from "../../api/types";
import { ClockTime } from "../../components/RelativeTime";
import { Notice } from "../../components/Tone";
import { whole } from "../../lib/format";
import { Trans, t } from "../../text";
import { lostChunks, type Period, total } from "./health";
import css from "./health.module.css";

/** s; a period that begins so much later than asked for was cut */
const LATE = 60;

/** The answer to "does everything arrive?" */
export function Verdict({ health, period }: { health: Reception; period: Period }) {
  const { since, until, waiting, rejected } = health;
  const lost = lostChunks(health);
  const cut = (Date.parse(until) - Date.parse(since)) / 1000 < period * 3600 - LATE;
  return (
    <div className={css.verdict}>
      {lost > 0 ? (
        <Notice
          tone="warn"
          icon={PackageX}
          title={t("history.health.missing", { count: lost, number: whole(lost) })}
        />
      ) : (
        <Notice
          tone="good"
          icon={CircleCheckBig}
          title={t(total(rejected) > 0 ? "history.health.arrived" : "history.health.good")}
        />
      )}
      {waiting > 0 && (
        <Notice
          tone="accent"
          icon={Hourglass}
          title={t("history.health.waiting", { count: waiting, number: whole(waiting) })}
        >
          <p>{t("history.health.waiting_about")}</p>
        </Notice>
      )}
      {cut && (
        <p className={css.quiet}>
          <Trans i18nKey="history.health.since" components={{ when: <ClockTime at={since} /> }} />
        </p>
      )}
    </div>
  );
}
