import { CircleCheckBig, Filter, Hourglass, PackageX } from "lucide-react";
import type { Reception } from "../../api/types";
import { ClockTime } from "../../components/RelativeTime";
import { Notice } from "../../components/Tone";
import { significant, whole } from "../../lib/format";
import { Trans, t } from "../../text";
import { lostChunks, type Period, unusedPercent } from "./health";
import css from "./health.module.css";

/** s; a period that begins so much later than asked for was cut */
const LATE = 60;

/** Per cent; more that is not used is worth a warning */
const MUCH = 5;

/** The answer to "does everything arrive?" */
export function Verdict({ health, period }: { health: Reception; period: Period }) {
  const { since, until, waiting } = health;
  const lost = lostChunks(health);
  const unused = unusedPercent(health);
  const cut = (Date.parse(until) - Date.parse(since)) / 1000 < period * 3600 - LATE;
  return (
    <div className={css.verdict}>
      {lost > 0 && (
        <Notice
          tone="warn"
          icon={PackageX}
          title={t("history.health.missing", { count: lost, number: whole(lost) })}
        />
      )}
      {unused > MUCH && (
        <Notice
          tone="warn"
          icon={Filter}
          title={t("history.health.unused", { percent: significant(unused, 2) })}
        />
      )}
      {waiting > 0 && <Waiting number={waiting} />}
      {lost + waiting === 0 && unused <= MUCH && (
        <Notice
          tone="good"
          icon={CircleCheckBig}
          title={t(unused > 0 ? "history.health.arrived" : "history.health.good")}
        />
      )}
      {cut && (
        <p className={css.quiet}>
          <Trans i18nKey="history.health.since" components={{ when: <ClockTime at={since} /> }} />
        </p>
      )}
    </div>
  );
}

function Waiting({ number }: { number: number }) {
  const title = t("history.health.waiting", { count: number, number: whole(number) });
  return (
    <Notice tone="accent" icon={Hourglass} title={title}>
      <p>{t("history.health.waiting_about")}</p>
    </Notice>
  );
}
