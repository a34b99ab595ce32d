import { describe, expect, it } from "vitest";
import type { Reception } from "../../api/types";
import { ends, lostChunks, rateColumns, reasons, unusedPercent, usual } from "./health";

const RECEPTION: Reception = {
  since: "2025-11-21T10:00:00Z",
  until: "2025-11-22T10:00:00Z",
  chunks: 4,
  samples: 9000,
  fixes: 800,
  rejected: { fix_implausible: 50, duplicate_time: 150, unusable: 0 },
  waiting: 0,
  lost: [
    { session: "a", from_seq: 3, to_seq: 3, before: "2025-11-22T09:00:00Z" },
    { session: "a", from_seq: 5, to_seq: 9, before: "2025-11-22T09:30:00Z" },
  ],
  sessions: [],
  rates: { time: [], sample_rate_hz: [], fix_rate_hz: [], rejected: [] },
};

it("counts chunks, not gaps", () => expect(lostChunks(RECEPTION)).toBe(6));

it("tells reasons by their weight, with their share of everything that came", () =>
  expect(reasons(RECEPTION)).toEqual([
    { reason: "duplicate_time", number: 150, percent: 1.5 },
    { reason: "fix_implausible", number: 50, percent: 0.5 },
  ]));

it("adds up what was not used", () => {
  expect(unusedPercent(RECEPTION)).toBeCloseTo(2);
  expect(unusedPercent({ ...RECEPTION, rejected: {} })).toBe(0);
});

describe("usual", () => {
  it("is not misled by a few short chunks, and knows of none where nothing is known", () => {
    expect(usual([50, 50, null, 3, 50, 100])).toBe(50);
    expect(usual([null])).toBeNull();
  });
});

describe("rateColumns", () => {
  const at = (minute: number) => new Date(Date.parse("2025-11-22T09:00:00Z") + 60_000 * minute).toISOString();
  const columns = (minutes: number[]) =>
    rateColumns({
      time: minutes.map(at),
      sample_rate_hz: minutes.map(() => 50),
      fix_rate_hz: minutes.map(() => null),
      rejected: minutes.map(() => 0),
    });

  it("breaks the line in a silence", () => {
    expect(columns([0, 1, 2, 30, 31]).samples).toEqual([50, 50, 50, null, 50, 50]);
    expect(columns([0, 1, 2, 4, 5]).samples).not.toContain(null);
  });
  it("takes chunks that came at once", () => expect(columns([0, 0, 0]).time).toHaveLength(3));
});

it("finds the ends of a column", () => {
  expect(ends([null, 3, 1])).toEqual([1, 3]);
  expect(ends([null])).toEqual([0, 0]);
});
