/** What is behind an alert, in words and as data for a chart. */
import { fixed } from "../lib/format";
import type { Vector } from "../lib/rotation";
import { onTheClock, toTheSecond } from "../lib/time";
import { pointing } from "../lib/words";

export type AlertData = Readonly<Record<string, unknown>>;

/** What a sequential test decided on. */
export interface EvidenceSeries {
  /** s since 1970, ascending */
  time: number[];
  value: number[];
  /** the value that decides */
  threshold: number;
  /** s since 1970: when it began, as far as it shows */
  since: number | null;
}

/** The series of an alert that has one and knows on which clock its times are. */
export function evidenceSeries(data: AlertData): EvidenceSeries | null {
  const { evidence, at, t } = data;
  if (typeof evidence !== "object" || evidence === null || typeof t !== "number") return null;
  const seen = evidence as Record<string, unknown>;
  const { value, threshold } = seen;
  const found = moment(at);
  if (found === null || !isNumbers(seen.t) || !isNumbers(value) || typeof threshold !== "number") return null;
  if (seen.t.length === 0 || seen.t.length !== value.length) return null;
  return { time: seen.t.map((look) => found + look - t), value, threshold, since: moment(data.since) };
}

/** When it began (RFC 3339), where that is known. */
export function beginning(data: AlertData): string | null {
  return moment(data.since) === null ? null : (data.since as string);
}

/** The chart in words, for those who do not see it. */
export function evidenceText({ time, value, threshold }: EvidenceSeries): string {
  const [first, last] = [value[0] ?? 0, value.at(-1) ?? 0];
  const crossed = value.findIndex((v) => v >= threshold);
  const went = `Evidence went from ${shortened(first)} at ${clock(time[0])} to ${shortened(last)} at ${clock(time.at(-1))}.`;
  const decides = `${shortened(threshold)} decides`;
  return crossed < 0
    ? `${went} ${decides}; it stayed below.`
    : `${went} ${decides}, reached at ${clock(time[crossed])}.`;
}

/** Vertical range of the chart: everything that was seen, and the threshold with room for its label. */
export function evidenceRange({ value, threshold }: EvidenceSeries): [number, number] {
  const least = Math.min(0, ...value);
  return [least, least + 1.15 * (Math.max(threshold, ...value) - least)];
}

const SPECIAL: Record<string, { label: string; unit?: string; words?: (value: unknown) => string }> = {
  t: { label: "found, log time", unit: " s" },
  at: { label: "found", words: clockWords },
  since_t: { label: "began, log time", unit: " s" },
  since: { label: "began", words: clockWords },
  axis: { label: "turned about", words: axisWords },
};
/** Told by the chart. */
const DRAWN = "evidence";

/** The rest of an alert's data, a line each. */
export function evidenceRows(data: AlertData): { name: string; label: string; text: string }[] {
  return Object.entries(data)
    .filter(([name, value]) => value !== null && name !== DRAWN)
    .map(([name, value]) => {
      const { label, unit, words = shortened } = { ...labelled(name), ...SPECIAL[name] };
      return { name, label, text: `${words(value)}${unit}` };
    });
}

function clockWords(value: unknown): string {
  const seconds = moment(value);
  return seconds === null ? shortened(value) : onTheClock(new Date(seconds * 1000));
}

/** "an axis pointing up and left (0.00, 0.57, 0.82)" */
function axisWords(value: unknown): string {
  if (!isNumbers(value) || value.length !== 3) return shortened(value);
  const components = value.map((component) => fixed(component, 2)).join(", ");
  return `an axis pointing ${pointing(value as unknown as Vector)} (${components})`;
}

const UNITS: Record<string, string> = { deg: "°", s: " s", mps: " m/s", mps2: " m/s²", hz: " Hz", m: " m" };

/** "angle_deg" is "angle", in degrees. */
export function labelled(name: string): { label: string; unit: string } {
  const words = name.split("_");
  const unit = words.length > 1 ? UNITS[words.at(-1) ?? ""] : undefined;
  return { label: (unit ? words.slice(0, -1) : words).join(" "), unit: unit ?? "" };
}

/** Numbers to four digits, lists of them likewise. */
export function shortened(value: unknown): string {
  if (typeof value === "number") return String(Number(value.toPrecision(4)));
  if (Array.isArray(value)) return value.map(shortened).join(", ");
  return typeof value === "string" ? value : JSON.stringify(value);
}

function clock(seconds: number | undefined): string {
  return toTheSecond(new Date((seconds ?? 0) * 1000));
}

/** s since 1970 of an RFC 3339 text */
function moment(value: unknown): number | null {
  const parsed = typeof value === "string" ? Date.parse(value) : Number.NaN;
  return Number.isNaN(parsed) ? null : parsed / 1000;
}

function isNumbers(value: unknown): value is number[] {
  return Array.isArray(value) && value.every((item) => typeof item === "number");
}
