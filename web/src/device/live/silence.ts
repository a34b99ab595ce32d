/** How long a device has said nothing. */

/** s; devices send a chunk about once a minute */
const SILENT = { warn: 120, bad: 300 };

export type Silence = "none" | keyof typeof SILENT;

/** s since the last data; a clock that is behind the service's gives 0. */
export function ageOf(lastDataAt: string, now: Date): number {
  return Math.max(0, (now.getTime() - Date.parse(lastDataAt)) / 1000);
}

export function silence(age: number): Silence {
  if (age >= SILENT.bad) return "bad";
  return age >= SILENT.warn ? "warn" : "none";
}
