/** An alert in the reader's language, from its kind and its data. */
import type { Alert, AlertKind } from "../api/types";
import { degreesText, fixed, listed, whole } from "../lib/format";
import type { Vector } from "../lib/rotation";
import { duration, onTheClock } from "../lib/time";
import { t } from "../text";

type Data = Alert["data"];

const FAULTS = ["left_handed", "stuck_axis", "saturated"] as const;
type Fault = (typeof FAULTS)[number];

/** What an alert means and calls for depends on its kind; of a sensor's fault, on which it is. */
function topic({ kind, data }: Alert): AlertKind | Fault {
  const fault = FAULTS.find((name) => name === data.fault);
  return kind === "sensor_fault" && fault ? fault : kind;
}

export const meaning = (alert: Alert): string => t(`alerts.meaning.${topic(alert)}`);
export const remedy = (alert: Alert): string => t(`alerts.remedy.${topic(alert)}`);

/** What was found, one sentence. */
export function finding(alert: Alert): string {
  const about = topic(alert);
  if (about === "orientation_changed") return moved(alert.data);
  if (about === "calibration_stalled" || about === "gps_lost") return lasted(about, alert.data);
  if (about === "verification_failing") return failed(alert.data);
  if (about === "device_silent") return silent(alert.data);
  if (about === "clock_fault") return clock(alert.data);
  if (about === "impact") return hit(alert.data);
  if (about === "harsh_driving") return harsh(alert.data);
  return t(`alerts.finding.${about}`);
}

function moved(data: Data): string {
  const angle = number(data.angle_deg);
  if (angle === null) return t("alerts.finding.moved_unknown");
  return t("alerts.finding.moved", { how: movement(angle, axisOf(data.axis)) });
}

const AXES = ["x", "y", "z"] as const;
/** Share of the axis' length below which a component is not worth a word. */
const NOTABLE = 0.25;

/** How a device moved, for somebody who sits in the vehicle; of a mix each part, the largest first, and the whole. */
export function movement(angle: number, axis: Vector | null): string {
  const degrees = degreesText(Math.abs(angle));
  if (!axis) return t("alerts.movement.whole", { degrees });
  const parts = AXES.map((name, i) => ({ name, share: axis[i] ?? 0 }))
    .filter(({ share }) => Math.abs(share) >= NOTABLE)
    .sort((a, b) => Math.abs(b.share) - Math.abs(a.share));
  if (parts.length === 1) return parts.map(({ name, share }) => part(name, Math.sign(share) * angle)).join();
  const told = listed(parts.map(({ name, share }) => part(name, share * angle)));
  return t("alerts.movement.several", { parts: told, degrees });
}

function part(axis: (typeof AXES)[number], degrees: number): string {
  const way = degrees > 0 ? "positive" : "negative";
  return t(`alerts.movement.${axis}_${way}`, { degrees: degreesText(Math.abs(degrees)) });
}

function lasted(about: "calibration_stalled" | "gps_lost", data: Data): string {
  const seconds = number(data.seen);
  if (seconds === null) return t(`alerts.finding.${about}_unknown`);
  return t(`alerts.finding.${about}`, { time: duration(60 * Math.round(seconds / 60)) });
}

function failed(data: Data): string {
  const count = number(data.seen);
  if (count === null) return t("alerts.finding.verification_failing_unknown");
  return t("alerts.finding.verification_failing", { count, number: whole(count) });
}

function silent(data: Data): string {
  if (typeof data.since !== "string") return t("alerts.finding.device_silent_unknown");
  return t("alerts.finding.device_silent", { when: onTheClock(new Date(data.since)) });
}

/** Which fault of the clock it is, is told by the unit; two of them are seconds, and the service's words tell them apart. */
function clock({ seen, unit, reason }: Data): string {
  const size = number(seen);
  const words = typeof reason === "string" ? reason : "";
  if (unit === "share of samples") return t("alerts.finding.clock_standing");
  if (size === null) return t("alerts.finding.clock_fault");
  if (unit === "per cent") return t("alerts.finding.clock_fast", { percent: fixed(size, 0) });
  const seconds = fixed(size, 0);
  if (words.includes("run back")) return t("alerts.finding.clock_back", { seconds });
  return words.includes("ahead")
    ? t("alerts.finding.clock_ahead", { seconds })
    : t("alerts.finding.clock_fault");
}

const SIDES = [
  "front",
  "front_left",
  "left",
  "rear_left",
  "rear",
  "rear_right",
  "right",
  "front_right",
] as const;
const KMH = 3.6;

/** Where the push came from is told anti-clockwise from forward, an eighth of the circle each. */
function hit({ direction_deg, speed_change_mps: change }: Data): string {
  const direction = number(direction_deg);
  if (direction === null || !Array.isArray(change)) return t("alerts.finding.impact_unknown");
  const side = SIDES[(Math.round(direction / 45) + SIDES.length) % SIDES.length] ?? "front";
  const [forward, left] = change.map((part) => number(part) ?? 0);
  return t("alerts.finding.impact", {
    side: t(`alerts.side.${side}`),
    change: fixed(Math.hypot(forward ?? 0, left ?? 0) * KMH, 0),
  });
}

function harsh(data: Data): string {
  const count = number(data.seen);
  if (count === null) return t("alerts.finding.harsh_driving_unknown");
  return t("alerts.finding.harsh_driving", { number: whole(count) });
}

function number(value: unknown): number | null {
  return typeof value === "number" && Number.isFinite(value) ? value : null;
}

function axisOf(value: unknown): Vector | null {
  const isAxis =
    Array.isArray(value) && value.length === 3 && value.every((part) => typeof part === "number");
  return isAxis ? (value as unknown as Vector) : null;
}
