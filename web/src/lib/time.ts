/** Times for people. The service sends RFC 3339 UTC; people read their own clock, as their region writes it. */
import { locale, t } from "../text";

const STEPS: readonly { unit: Intl.RelativeTimeFormatUnit; seconds: number }[] = [
  { unit: "year", seconds: 31_557_600 },
  { unit: "month", seconds: 2_629_800 },
  { unit: "day", seconds: 86_400 },
  { unit: "hour", seconds: 3600 },
  { unit: "minute", seconds: 60 },
];

const made = new Map<string, Intl.DateTimeFormat>();

/** Formats are costly to make, and a table of times needs one of them many times. */
function format(options: Intl.DateTimeFormatOptions): Intl.DateTimeFormat {
  const name = `${locale()} ${JSON.stringify(options)}`;
  const known = made.get(name) ?? new Intl.DateTimeFormat(locale(), options);
  made.set(name, known);
  return known;
}

/** "just now", "25 seconds ago", "3 hours ago". A clock that runs ahead of the service's gives "just now". */
export function ago(then: Date, now: Date): string {
  const seconds = (now.getTime() - then.getTime()) / 1000;
  if (seconds < 5) return t("common.just_now");
  const relative = new Intl.RelativeTimeFormat(locale(), { numeric: "always" });
  for (const step of STEPS) {
    if (seconds >= step.seconds) return relative.format(-Math.floor(seconds / step.seconds), step.unit);
  }
  return relative.format(-Math.floor(seconds), "second");
}

/** "22 Nov 2025, 10:20" on the reader's clock. */
export function onTheClock(time: Date): string {
  return format({ dateStyle: "medium", timeStyle: "short" }).format(time);
}

/** "22 Nov 2025, 10:20:05" on the reader's clock. */
export function exactly(time: Date): string {
  return format({ dateStyle: "medium", timeStyle: "medium" }).format(time);
}

/** "10:20:05" on the reader's clock. */
export function toTheSecond(time: Date): string {
  return format({ timeStyle: "medium" }).format(time);
}

/** "22 Nov 2025, 10:20 – 11:40" on the reader's clock; with seconds where it is short. */
export function between(from: Date, to: Date): string {
  const timeStyle = to.getTime() - from.getTime() < 600_000 ? "medium" : "short";
  return format({ dateStyle: "medium", timeStyle }).formatRange(from, to);
}

/** How the marks of a time axis are written whose steps (s) are shorter than this. */
const TICKS: readonly [number, Intl.DateTimeFormatOptions][] = [
  [60, { hour: "2-digit", minute: "2-digit", second: "2-digit" }],
  [86_400, { hour: "2-digit", minute: "2-digit" }],
  [25 * 86_400, { day: "numeric", month: "short" }],
  [Number.POSITIVE_INFINITY, { month: "short", year: "numeric" }],
];
const DATE = { day: "numeric", month: "short" } as const;

/** Marks of a time axis (s since 1970), as fine as the steps between them; midnight shows the date. */
export function tickTimes(ticks: readonly number[], step: number): string[] {
  const usual = TICKS.find(([longest]) => step < longest)?.[1] ?? DATE;
  return ticks.map((tick) => {
    const time = new Date(tick * 1000);
    const midnight = time.getHours() + time.getMinutes() + time.getSeconds() === 0;
    return format(midnight && step < 86_400 ? DATE : usual).format(time);
  });
}

/** Seconds as people say them: "23 s", "4 min", "2 h 5 min". */
export function duration(seconds: number): string {
  if (seconds < 60) return `${Math.floor(seconds)} s`;
  const minutes = Math.floor(seconds / 60);
  if (minutes < 60) return `${minutes} min`;
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}
