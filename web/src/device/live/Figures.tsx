import {
  Check,
  Clock,
  Gauge,
  type LucideIcon,
  Rotate3d,
  Satellite,
  SatelliteDish,
  Waves,
  X,
} from "lucide-react";
import type { LastData } from "../../api/types";
import { useLive } from "../../app/Live";
import { fixed, significant, whole } from "../../lib/format";
import { ago, toTheSecond } from "../../lib/time";
import { t } from "../../text";
import css from "./live.module.css";
import { ageOf, silence } from "./silence";
import { LEAST } from "./troubles";

interface FiguresProps {
  data: LastData | null;
  /** when the last data came */
  at: string;
  now: Date;
}

/** What the device sends, as it was in its last data; grey while nobody knows whether that is still so. */
export function Figures({ data, at, now }: FiguresProps) {
  const live = useLive();
  return (
    <dl className={css.figures} data-live={live} aria-label={t("device.figure.list")}>
      {data && <DataFigures data={data} />}
      <LastHeard at={at} now={now} live={live} />
    </dl>
  );
}

function DataFigures({ data: { has_fix, speed_mps, sample_rate_hz, gyroscope } }: { data: LastData }) {
  const speed = speed_mps === null ? null : `${fixed(speed_mps * 3.6, 0)} km/h`;
  const rate = sample_rate_hz === null ? null : `${significant(sample_rate_hz, 3)} Hz`;
  return (
    <>
      <Figure
        icon={has_fix ? Satellite : SatelliteDish}
        word={t("device.figure.gps")}
        state={has_fix ? "good" : "warn"}
      >
        <YesNo yes={has_fix} />
      </Figure>
      <Figure icon={Gauge} word={t("device.figure.speed")}>
        {speed ?? t("common.unknown")}
      </Figure>
      <Figure
        icon={Waves}
        word={t("device.figure.rate")}
        state={sample_rate_hz !== null && sample_rate_hz < LEAST.samples ? "bad" : "none"}
      >
        {rate ?? t("common.unknown")}
      </Figure>
      <Figure icon={Rotate3d} word={t("device.figure.gyroscope")}>
        <YesNo yes={gyroscope} />
      </Figure>
    </>
  );
}

function LastHeard({ at, now, live }: { at: string; now: Date; live: boolean }) {
  const age = ageOf(at, now);
  return (
    <Figure icon={Clock} word={t("device.figure.last")} state={live ? silence(age) : "none"}>
      <time dateTime={at}>
        {live ? agoText(at, now) : t("device.figure.as_of", { time: toTheSecond(new Date(at)) })}
      </time>
    </Figure>
  );
}

/** Within the first minute each second counts: that is how one sees that data comes in. */
function agoText(at: string, now: Date): string {
  const age = ageOf(at, now);
  return age < 60
    ? t("device.figure.seconds_ago", { seconds: whole(Math.floor(age)) })
    : ago(new Date(at), now);
}

interface FigureProps {
  icon: LucideIcon;
  word: string;
  state?: "none" | "good" | "warn" | "bad";
  children: React.ReactNode;
}

function Figure({ icon: Icon, word, state = "none", children }: FigureProps) {
  return (
    <div data-state={state}>
      <dt>
        <Icon size={16} aria-hidden /> {word}
      </dt>
      <dd>{children}</dd>
    </div>
  );
}

function YesNo({ yes }: { yes: boolean }) {
  const Icon = yes ? Check : X;
  return (
    <>
      <Icon size={18} strokeWidth={3} aria-hidden /> {t(yes ? "common.yes" : "common.no")}
    </>
  );
}
