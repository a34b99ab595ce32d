/** What happened to a vehicle, as the page tells it. */
import { CircleGauge, Construction, type LucideIcon, OctagonAlert, Rewind, TrendingUp } from "lucide-react";
import type { MotionEvent, MotionEventKind } from "../api/types";
import { fixed } from "../lib/format";
import { t } from "../text";
import { GRAVITY } from "./drive";
import { fromWhere } from "./push";

const KMH = 3.6;

export interface Happening {
  /** s since 1970, of the peak */
  time: number;
  grave: boolean;
}

export const ICON: Record<MotionEventKind, LucideIcon> = {
  impact: OctagonAlert,
  harsh_braking: Rewind,
  harsh_acceleration: TrendingUp,
  harsh_cornering: CircleGauge,
  pothole: Construction,
};

export function happening({ at, kind }: MotionEvent): Happening {
  return { time: Date.parse(at) / 1000, grave: kind === "impact" };
}

/** "1.2 g" */
export const inG = (mps2: number): string => `${fixed(mps2 / GRAVITY, mps2 < 10 * GRAVITY ? 1 : 0)}\u00a0g`;

/** "25 km/h" */
export const inKmh = (mps: number): string => `${fixed(mps * KMH, 0)}\u00a0km/h`;

/** "90 ms" below a second, "1.8 s" above. */
export function lasting(seconds: number): string {
  return seconds < 1 ? `${fixed(seconds * 1000, 0)}\u00a0ms` : `${fixed(seconds, 1)}\u00a0s`;
}

/** Size of the change of speed on the plan, m/s. */
export const changeOf = ({ speed_change_mps: [forward, left] }: MotionEvent): number =>
  Math.hypot(forward ?? 0, left ?? 0);

/** One line: how hard, from where, how long. */
export function summary(event: MotionEvent): string {
  const { kind, peak_mps2, direction_deg, duration_s } = event;
  const values = { peak: inG(peak_mps2), time: lasting(duration_s) };
  if (kind !== "impact" || direction_deg === null) return t("motion.event.summary", values);
  return t("motion.event.impact_summary", {
    ...values,
    side: fromWhere(direction_deg),
    change: inKmh(changeOf(event)),
  });
}
