import { describe, expect, it } from "vitest";
import { toTheSecond } from "../lib/time";
import { beginning, evidenceRange, evidenceSeries, evidenceText, shortened } from "./evidence";

const FOUND = Date.parse("2025-11-22T10:08:30Z") / 1000;
const MOVED = {
  session: "a",
  t: 510,
  at: "2025-11-22T10:08:30.000Z",
  since_t: 492,
  since: "2025-11-22T10:08:12.000Z",
  mount: 3,
  angle_deg: 14.004,
  axis: [0, -0.1, 0.995],
  evidence: { t: [500, 505, 510], value: [0, 25, 61.5], threshold: 60 },
  fault: null,
};

describe("evidenceSeries", () => {
  it("puts the session's clock on the wall", () => {
    expect(evidenceSeries(MOVED)).toEqual({
      time: [FOUND - 10, FOUND - 5, FOUND],
      value: [0, 25, 61.5],
      threshold: 60,
      since: FOUND - 18,
    });
    expect(evidenceSeries({ ...MOVED, since: null })?.since).toBeNull();
  });

  it.each([
    ["no evidence", { evidence: null }],
    ["nothing of the kind", { evidence: "60" }],
    ["no looks", { evidence: { t: [], value: [], threshold: 60 } }],
    ["columns of different length", { evidence: { t: [1, 2], value: [1], threshold: 60 } }],
    ["no threshold", { evidence: { t: [1], value: [1] } }],
    ["other things than numbers", { evidence: { t: [1], value: ["1"], threshold: 60 } }],
    ["no time on the wall", { at: null }],
    ["no time of the session", { t: null }],
  ])("draws nothing where there is %s", (_, change) =>
    expect(evidenceSeries({ ...MOVED, ...change })).toBeNull(),
  );
});

describe("evidenceText", () => {
  const clock = (t: number) => toTheSecond(new Date(t * 1000));
  const text = (value: number[]) =>
    evidenceText({ time: [FOUND - 10, FOUND - 5, FOUND], value, threshold: 60, since: null });
  it("says when the threshold was reached", () =>
    expect(text([0, 61.234, 65])).toBe(
      `Evidence went from 0 at ${clock(FOUND - 10)} to 65 at ${clock(FOUND)}. 60 decides, reached at ${clock(FOUND - 5)}.`,
    ));
  it("says when it was not", () => expect(text([0, 1, 2])).toContain("60 decides; it stayed below."));
});

it.each([
  [[0, 25, 61], 0, 70.15],
  [[0, 25], 0, 69],
  [[-40, 10], -40, 75],
])("evidence %o is drawn from %d to %d", (value, low, high) => {
  const [least, most] = evidenceRange({ time: value, value, threshold: 60, since: null });
  expect([least, most]).toEqual([low, expect.closeTo(high)]);
});

it("knows when it began, where that is known", () => {
  expect(beginning(MOVED)).toBe(MOVED.since);
  expect(beginning({ since: null })).toBeNull();
  expect(beginning({ since: "long ago" })).toBeNull();
  expect(beginning({})).toBeNull();
});

it.each([
  [83.21745, "83.22"],
  [[0.1234567, 2], "0.1235, 2"],
  ["gyroscope", "gyroscope"],
  [true, "true"],
  [{ a: 1 }, '{"a":1}'],
])("%o is shortened", (value, expected) => expect(shortened(value)).toBe(expected));
