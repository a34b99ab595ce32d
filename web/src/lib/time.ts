/** Times for people. The service sends RFC 3339 UTC; people read their own clock. */

const STEPS: readonly { unit: Intl.RelativeTimeFormatUnit; seconds: number }[] = [
  { unit: "year", seconds: 31_557_600 },
  { unit: "month", seconds: 2_629_800 },
  { unit: "day", seconds: 86_400 },
  { unit: "hour", seconds: 3600 },
  { unit: "minute", seconds: 60 },
];
const relative = new Intl.RelativeTimeFormat("en", { numeric: "always" });
const second = new Intl.DateTimeFormat("en-GB", { timeStyle: "medium" });
const moment = new Intl.DateTimeFormat("en-GB", { dateStyle: "medium", timeStyle: "short" });

/** "just now", "25 seconds ago", "3 hours ago". A clock that runs ahead of the service's gives "just now". */
export function ago(then: Date, now: Date): string {
  const seconds = (now.getTime() - then.getTime()) / 1000;
  if (seconds < 5) return "just now";
  for (const step of STEPS) {
    if (seconds >= step.seconds) return relative.format(-Math.floor(seconds / step.seconds), step.unit);
  }
  return relative.format(-Math.floor(seconds), "second");
}

/** "22 Nov 2025, 10:20" on the reader's clock. */
export function onTheClock(time: Date): string {
  return moment.format(time);
}

/** "10:20:05" on the reader's clock. */
export function toTheSecond(time: Date): string {
  return second.format(time);
}

/** Seconds as people say them: "23 s", "4 min", "2 h 5 min". */
export function duration(seconds: number): string {
  if (seconds < 60) return `${Math.floor(seconds)} s`;
  const minutes = Math.floor(seconds / 60);
  if (minutes < 60) return `${minutes} min`;
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}
