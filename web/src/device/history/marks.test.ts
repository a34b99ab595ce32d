import { describe, expect, it } from "vitest";
import type { Alert, Mount } from "../../api/types";
import { flagged, marksOf, within } from "./marks";
import { estimates, START } from "./sample";

const at = (seconds: number) => new Date((START + seconds) * 1000).toISOString();
const DRIVES = estimates([
  { t: 10, session: "a", stage: "aligning" },
  { t: 20, session: "a", stage: "settling" },
  { t: 30, session: "a", stage: "confirmed" },
  { t: 900, session: "b", stage: "confirmed" },
  { t: 910, session: "b", stage: "settling" },
]);
const MOUNT = { id: 4, confirmed_at: at(29) } as Mount;
const ALERT = {
  id: 1,
  kind: "orientation_changed",
  opened_at: at(2000),
  resolved_at: at(3000),
  data: { session: "b", t: 905, at: at(1999) },
} as unknown as Alert;
const told = (alerts: Alert[] = [], mounts: Mount[] = [MOUNT]) =>
  marksOf({ estimates: DRIVES, mounts, alerts }).map(({ time, text }) => `${time - START} ${text}`);

describe("marksOf", () => {
  it("tells sessions, stages and mountings in their order, and a confirmation once", () =>
    expect(told()).toEqual([
      "10 Session a begins",
      "20 Stage: Settling",
      "29 Mounting 4 confirmed",
      "900 Session b begins",
      "910 Stage: Settling",
    ]));

  it("puts an alert where the clock of its session says, beside the curve it is about", () => {
    expect(told([ALERT])).toContain("905 Alert: Device turned");
    expect(told([ALERT])).toContain("3000 Alert resolved: Device turned");
  });

  it("puts an alert of an unknown session where it was found, else where it was opened", () => {
    const elsewhere = { ...ALERT, data: { session: "z", t: 5, at: at(1999) }, resolved_at: null };
    expect(told([elsewhere as Alert])).toContain("1999 Alert: Device turned");
    expect(told([{ ...elsewhere, data: {} } as Alert])).toContain("2000 Alert: Device turned");
  });

  it("tells sessions that overlap once each", () => {
    const overlapping = estimates([
      { t: 0, session: "a", stage: "confirmed" },
      { t: 1, session: "b", stage: "aligning" },
      { t: 2, session: "a", stage: "confirmed" },
      { t: 3, session: "b", stage: "aligning" },
    ]);
    const marks = marksOf({ estimates: overlapping, mounts: [], alerts: [] });
    expect(marks.map(({ text }) => text)).toEqual([
      "Session a begins",
      "Session b begins",
      "Stage: Aligning",
    ]);
  });

  it("takes nothing", () =>
    expect(marksOf({ estimates: estimates([]), mounts: [], alerts: [] })).toEqual([]));
});

it("gives the marks of a span", () => {
  const marks = marksOf({ estimates: DRIVES, mounts: [MOUNT], alerts: [] });
  expect(within(marks, { min: START + 20, max: START + 29 })).toHaveLength(2);
});

it("gives no two flags the same place, and the place to the more important one", () => {
  const session = { kind: "session", from: 0, to: 50 } as const;
  const opened = { kind: "opened", from: 40, to: 90 } as const;
  const far = { kind: "session", from: 91, to: 120 } as const;
  expect(flagged([session, opened, far])).toEqual([opened, far]);
});
