/** The two speeds that a drive test compares. */
import type { Installation, SpeedTrace, Verification } from "../../api/types";
import { fixed } from "../../lib/format";
import { t } from "../../text";

/** s of driving after which a test ends in any case */
const LONGEST = 120;
const KMH = 3.6;

/** A speed in m/s as people read it. */
export const kmh = (mps: number): string => fixed(Math.abs(mps) * KMH, 1);

/** The test that the page speaks of: the present or last one, else that of the mounting in force. */
export function spokenOf({ verification, mount }: Installation): Verification {
  const past = mount?.status === "in_force" ? mount.verification : null;
  return verification.state === "idle" && past ? past : verification;
}

export interface Countdown {
  /** s of driving */
  left: number;
  /** 0..1 */
  share: number;
  /** the usual time is over, and the result is not yet sure enough */
  goesOn: boolean;
}

export function countdown({ elapsed_s, duration_s }: Verification): Countdown {
  const goesOn = elapsed_s >= duration_s;
  const end = goesOn ? LONGEST : duration_s;
  const left = Math.max(0, Math.ceil(end - elapsed_s));
  return { left, share: Math.min(elapsed_s / end, 1), goesOn };
}

export interface Speeds {
  /** s since the test began */
  time: number[];
  /** km/h */
  gps: number[];
  sensor: number[];
}

/** Null where there is too little for a line. */
export function speeds(trace: SpeedTrace | null): Speeds | null {
  const start = trace?.t[0];
  if (!trace || start === undefined || trace.t.length < 2) return null;
  return {
    time: trace.t.map((time) => time - start),
    gps: trace.gps_mps.map((speed) => speed * KMH),
    sensor: trace.sensor_mps.map((speed) => speed * KMH),
  };
}

/** What the chart shows, for somebody who cannot see it. */
export function speedsSay({ time, gps, sensor }: Speeds): string {
  const gap = gps.reduce((most, speed, row) => Math.max(most, Math.abs(speed - (sensor[row] ?? speed))), 0);
  const value = (column: readonly number[], row: number) => fixed(column.at(row) ?? 0, 0);
  return t("device.test.chart_says", {
    seconds: fixed(time.at(-1) ?? 0, 0),
    gps_first: value(gps, 0),
    gps_last: value(gps, -1),
    sensor_first: value(sensor, 0),
    sensor_last: value(sensor, -1),
    gap: fixed(gap, 1),
  });
}
