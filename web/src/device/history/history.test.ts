import { describe, expect, it } from "vitest";
import type { Estimates } from "../../api/types";
import { angleHistory, rangeStart, verticalRange } from "./history";

const START = Date.parse("2025-11-22T10:00:00Z") / 1000;

function estimates(
  rows: { t: number; yaw: number; sigma?: number; session?: string; stage?: "aligning" }[],
): Estimates {
  const fill = <T>(value: T) => rows.map(() => value);
  return {
    session: rows.map(({ session }) => session ?? "s"),
    t: rows.map(({ t }) => t),
    time: rows.map(({ t }) => new Date((START + t) * 1000).toISOString()),
    quaternion: fill([1, 0, 0, 0]),
    angles_deg: { roll: fill(0), pitch: fill(1), yaw: rows.map(({ yaw }) => yaw) },
    sigma_deg: rows.map(({ sigma }) => [0.1, 0.2, sigma ?? 0.5]),
    stage: rows.map(({ stage }) => stage ?? "settling"),
    stable: fill(false),
    reliable: fill(false),
    progress: fill(0.5),
  };
}

describe("angleHistory", () => {
  it("draws no jump where yaw passes 180 degrees, and the band goes along", () => {
    const { angles } = angleHistory(
      estimates([
        { t: 0, yaw: 179.5 },
        { t: 5, yaw: -179.5 },
      ]),
    );
    expect(angles.yaw.value).toEqual([-180.5, -179.5]);
    expect(angles.yaw.low).toEqual([-181, -180]);
    expect(angles.yaw.high).toEqual([-180, -179]);
  });

  it("takes each angle's own sigma", () => {
    const { angles } = angleHistory(estimates([{ t: 0, yaw: 0 }]));
    expect(angles.roll.high).toEqual([0.1]);
    expect(angles.pitch.high).toEqual([1.2]);
  });

  it("leaves a gap after a long silence and between sessions", () => {
    const { time, angles } = angleHistory(
      estimates([
        { t: 0, yaw: 1 },
        { t: 5, yaw: 2 },
        { t: 605, yaw: 3 },
        { t: 610, yaw: 4, session: "next" },
      ]),
    );
    expect(angles.yaw.value).toEqual([1, 2, null, 3, null, 4]);
    expect(time.map((t) => t - START)).toEqual([0, 5, 305, 605, 607.5, 610]);
  });

  it("joins what the service thinned out evenly", () => {
    const thinned = estimates([0, 600, 1200, 1800].map((t) => ({ t, yaw: 1 })));
    expect(angleHistory(thinned).angles.yaw.value).not.toContain(null);
  });

  it("takes no rows", () => expect(angleHistory(estimates([])).time).toEqual([]));
});

describe("verticalRange", () => {
  const range = (rows: Parameters<typeof estimates>[0]) =>
    verticalRange(angleHistory(estimates(rows)), "yaw");

  it("shows at least four degrees", () => {
    const [low, high] = range([{ t: 0, yaw: 50, sigma: 0.1 }]);
    expect(high - low).toBeGreaterThanOrEqual(4);
    expect((low + high) / 2).toBeCloseTo(50);
  });

  it("is not blown up by the first, rough estimates", () => {
    const [low, high] = range([
      { t: 0, yaw: -80, sigma: 20, stage: "aligning" },
      { t: 5, yaw: 52, sigma: 0.5 },
    ]);
    expect(low).toBeGreaterThan(45);
    expect(high).toBeLessThan(57);
  });

  it("shows them while there are no others", () => {
    expect(range([{ t: 0, yaw: -80, sigma: 20, stage: "aligning" }])[0]).toBeLessThan(-100);
  });
});

describe("rangeStart", () => {
  it("counts back from the last data, on the minute", () => {
    expect(rangeStart("Hour", "2025-11-22T10:00:59Z")).toBe("2025-11-22T09:00:00.000Z");
    expect(rangeStart("Hour", "2025-11-22T10:00:01Z")).toBe("2025-11-22T09:00:00.000Z");
  });
  it("has no beginning for everything, or for nothing", () => {
    expect(rangeStart("All", "2025-11-22T10:00:00Z")).toBeNull();
    expect(rangeStart("Day", null)).toBeNull();
  });
});
