import { type ReactNode, useCallback, useEffect, useState } from "react";
import { TimeAxis } from "../device/history/timeAxis";
import { t } from "../text";
import { AttitudePicture } from "./AttitudePicture";
import { CHARTS } from "./charts";
import { type Drive, rowAt } from "./drive";
import { FrictionCircle } from "./FrictionCircle";
import type { Happening } from "./happenings";
import css from "./motion.module.css";
import { Player } from "./Player";
import { SeriesChart } from "./SeriesChart";
import { TrackMap } from "./TrackMap";

interface PicturesProps {
  drive: Drive;
  happenings: readonly Happening[];
  /** s since 1970, the moment to begin with; else the last one */
  begin?: number;
}

/** One moment of the drive in all pictures, chosen on any chart or played. */
export function Pictures({ drive, happenings, begin }: PicturesProps) {
  const last = drive.time.length - 1;
  const [chosen, setChosen] = useState(() => (begin === undefined ? null : rowAt(drive.time, begin)));
  const row = Math.min(chosen ?? last, last);
  const choose = useCallback((at: number | null) => at !== null && setChosen(at), []);
  return (
    <div className={css.all}>
      <Player time={drive.time} row={row} onRow={choose} />
      <div className={css.three}>
        <Picture title={t("motion.attitude.title")}>
          <AttitudePicture drive={drive} row={row} />
        </Picture>
        <Picture title={t("motion.circle.title")}>
          <FrictionCircle drive={drive} row={row} />
        </Picture>
        <Picture title={t("motion.track.title")}>
          <TrackMap drive={drive} row={row} happenings={happenings} />
        </Picture>
      </div>
      <Charts drive={drive} happenings={happenings} row={row} onRow={choose} />
    </div>
  );
}

function Picture({ title, children }: { title: string; children: ReactNode }) {
  return (
    <div className={css.picture}>
      <h3>{title}</h3>
      {children}
    </div>
  );
}

interface ChartsProps extends PicturesProps {
  row: number;
  onRow: (row: number | null) => void;
}

/** The charts share one time axis; another stretch of driving begins unzoomed. */
export function Charts({ drive, happenings, row, onRow }: ChartsProps) {
  const [axis] = useState(() => new TimeAxis());
  const [, redraw] = useState(0);
  const { time } = drive;
  useEffect(() => {
    axis.reset();
    axis.limits = { min: time[0] ?? 0, max: time.at(-1) ?? 1 };
    axis.loaded = axis.limits;
    redraw((count) => count + 1);
    return () => axis.stop();
  }, [axis, time]);
  const reset = useCallback(() => {
    axis.look({ min: time[0] ?? 0, max: time.at(-1) ?? 1 });
    axis.reset();
  }, [axis, time]);
  const names = CHARTS.filter(({ lines }) => lines.length > 1).flatMap(({ lines }) =>
    lines.map(({ of }) => t(`motion.line.${of}`)),
  );
  return (
    <div className={css.charts}>
      {CHARTS.map(({ name, unit, digits, leastSpan, fromZero, lines }) => (
        <SeriesChart
          key={name}
          title={t(`motion.chart.${name}`)}
          unit={unit}
          digits={digits}
          leastSpan={leastSpan}
          fromZero={fromZero}
          names={names}
          time={time}
          lines={lines.map(({ of, ...line }) => ({
            ...line,
            name: t(`motion.line.${of}`),
            column: drive[of],
          }))}
          axis={axis}
          happenings={happenings}
          row={row}
          onCursor={onRow}
          onReset={reset}
        />
      ))}
    </div>
  );
}
