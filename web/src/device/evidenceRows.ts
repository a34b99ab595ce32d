/** The data of an alert, a line each, in the reader's language. */
import { degreesText, fixed, significant } from "../lib/format";
import type { Vector } from "../lib/rotation";
import { duration, onTheClock } from "../lib/time";
import { pointing } from "../lib/words";
import { t } from "../text";
import { history } from "../text/en/history";
import { type AlertData, isNumbers, moment, shortened } from "./evidence";

const TEXTS = history.evidence;
type Label = keyof typeof TEXTS.label;
type Words = (value: unknown, data: AlertData) => string;

/** How each field is told, in the order in which they are; what is not here comes after them as it is. */
const FIELDS: Record<Label, Words> = {
  since: momentText,
  at: momentText,
  seen: measured,
  threshold: measured,
  angle_deg: (value) => numberText(value, degreesText),
  axis: axisText,
  direction_deg: (value) => numberText(value, degreesText),
  peak_mps2: (value) => numberText(value, (peak) => `${significant(peak, 3)} m/s²`),
  duration_s: (value) => numberText(value, (seconds) => `${significant(seconds, 3)} s`),
  speed_change_mps: (value) =>
    isNumbers(value) ? `${value.map(speedText).join(" / ")} m/s` : shortened(value),
  speed_mps: (value) => numberText(value, (speed) => `${speedText(speed)} m/s`),
  fault: faultText,
  reason: (value) => (typeof value === "string" ? reasonText(value) : shortened(value)),
  mount: (value) => t("history.evidence.number", { number: shortened(value) }),
  sigma_deg: sigmaText,
  quaternion: (value) =>
    isNumbers(value) ? value.map((part) => part.toFixed(6)).join(", ") : shortened(value),
  session: shortened,
  since_t: secondsText,
  t: secondsText,
};
/** Told by the chart, or together with another field. */
const ELSEWHERE = new Set(["evidence", "unit", "event"]);

/** The rest of an alert's data, a line each. */
export function evidenceRows(data: AlertData, kind: string): { name: string; label: string; text: string }[] {
  const names = [...Object.keys(FIELDS), ...Object.keys(data).filter((name) => !(name in FIELDS))];
  return names
    .filter((name) => data[name] != null && !ELSEWHERE.has(name))
    .map((name) =>
      isKnown(name)
        ? { name, label: labelOf(name, data, kind), text: FIELDS[name](data[name], data) }
        : { name, label: name, text: shortened(data[name]) },
    );
}

function isKnown(name: string): name is Label {
  return name in FIELDS;
}

/** "Seen" says more where it is known what: `clock_fault` measures one of three things, told apart by their unit. */
function labelOf(name: Label, { unit }: AlertData, kind: string): string {
  const seen = kind === "clock_fault" ? CLOCK[String(unit)] : kind;
  if (name === "seen" && seen && seen in TEXTS.seen) {
    return t(`history.evidence.seen.${seen as keyof typeof TEXTS.seen}`);
  }
  return t(`history.evidence.label.${name}`);
}

const CLOCK: Record<string, string> = {
  s: "clock_s",
  "share of samples": "clock_share",
  "per cent": "clock_rate",
};

/** How a value is written in each unit that the service's rules measure in. */
const UNITS: Record<string, (value: number) => string> = {
  s: (value) => (value < 60 ? `${significant(value, 3)} s` : duration(value)),
  h: (value) => `${significant(value, 3)} h`,
  events: (count) => t("history.evidence.events", { count, number: significant(count, 3) }),
  tests: (count) => t("history.evidence.tests", { count, number: significant(count, 3) }),
  "share of samples": (value) => t("history.evidence.percent", { number: significant(100 * value, 3) }),
  "per cent": (value) => t("history.evidence.percent", { number: significant(value, 3) }),
};

function measured(value: unknown, { unit }: AlertData): string {
  const words = typeof unit === "string" ? UNITS[unit] : undefined;
  if (typeof value === "number" && words) return words(value);
  return typeof unit === "string" ? `${shortened(value)} ${unit}` : shortened(value);
}

function numberText(value: unknown, words: (value: number) => string): string {
  return typeof value === "number" ? words(value) : shortened(value);
}

const speedText = (speed: number): string => significant(speed, 3);

function secondsText(value: unknown): string {
  return numberText(value, (seconds) => `${fixed(seconds, 1)} s`);
}

function momentText(value: unknown): string {
  const seconds = moment(value);
  return seconds === null ? shortened(value) : onTheClock(new Date(seconds * 1000));
}

/** "an axis pointing up and left (0.00, 0.57, 0.82)" */
function axisText(value: unknown): string {
  if (!isNumbers(value) || value.length !== 3) return shortened(value);
  const components = value.map((part) => fixed(part, 2)).join(t("history.evidence.separator"));
  return t("history.evidence.axis", { direction: pointing(value as unknown as Vector), components });
}

function sigmaText(value: unknown): string {
  if (!isNumbers(value) || value.length !== 3) return shortened(value);
  const [roll = "", pitch = "", yaw = ""] = value.map(degreesText);
  return t("history.evidence.angles", { roll, pitch, yaw });
}

function faultText(value: unknown): string {
  const known = typeof value === "string" && value in TEXTS.fault;
  return known ? t(`history.evidence.fault.${value as keyof typeof TEXTS.fault}`) : shortened(value);
}

const NUMBER = "{{number}}";

/** The service gives its reasons in English; those that are known are told in the reader's language. */
export function reasonText(reason: string): string {
  const known = Object.entries(TEXTS.reason) as [keyof typeof TEXTS.reason, string][];
  return known.reduce(
    (text, [name, sentence]) =>
      text.replace(patternOf(sentence), (_, number: string) =>
        t(`history.evidence.reason.${name}`, { number }),
      ),
    reason,
  );
}

function patternOf(sentence: string): RegExp {
  const parts = sentence.split(NUMBER).map((part) => part.replaceAll(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  return new RegExp(parts.join("(\\d+)"));
}
