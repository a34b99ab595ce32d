/** What a test saw before it raised an alert, as data for a chart and in words. */
import { significant } from "../lib/format";
import { toTheSecond } from "../lib/time";
import { t } from "../text";

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
  const { evidence, at, t: clock } = data;
  if (typeof evidence !== "object" || evidence === null || typeof clock !== "number") return null;
  const seen = evidence as Record<string, unknown>;
  const { value, threshold } = seen;
  const found = moment(at);
  if (found === null || !isNumbers(seen.t) || !isNumbers(value) || typeof threshold !== "number") return null;
  if (seen.t.length === 0 || seen.t.length !== value.length) return null;
  return { time: seen.t.map((look) => found + look - clock), value, threshold, since: moment(data.since) };
}

/** When it began (RFC 3339), where that is known. */
export function beginning(data: AlertData): string | null {
  return moment(data.since) === null ? null : (data.since as string);
}

/** The chart in words, for those who do not see it. */
export function evidenceText({ time, value, threshold }: EvidenceSeries): string {
  const went = t("history.evidence.went", {
    first: shortened(value[0] ?? 0),
    start: clockText(time[0]),
    last: shortened(value.at(-1) ?? 0),
    end: clockText(time.at(-1)),
  });
  const crossed = value.findIndex((v) => v >= threshold);
  const decides = { threshold: shortened(threshold), when: clockText(time[crossed]) };
  return `${went} ${t(`history.evidence.${crossed < 0 ? "below" : "reached"}`, decides)}`;
}

/** Vertical range of the chart: everything that was seen, and the threshold with room for its label. */
export function evidenceRange({ value, threshold }: EvidenceSeries): [number, number] {
  const least = Math.min(0, ...value);
  return [least, least + 1.15 * (Math.max(threshold, ...value) - least)];
}

/** Numbers to four digits, lists of them likewise. */
export function shortened(value: unknown): string {
  if (typeof value === "number") return significant(value, 4);
  if (Array.isArray(value)) return value.map(shortened).join(t("history.evidence.separator"));
  return typeof value === "string" ? value : JSON.stringify(value);
}

function clockText(seconds: number | undefined): string {
  return toTheSecond(new Date((seconds ?? 0) * 1000));
}

/** s since 1970 of an RFC 3339 text */
export function moment(value: unknown): number | null {
  const parsed = typeof value === "string" ? Date.parse(value) : Number.NaN;
  return Number.isNaN(parsed) ? null : parsed / 1000;
}

export function isNumbers(value: unknown): value is number[] {
  return Array.isArray(value) && value.every((item) => typeof item === "number");
}
