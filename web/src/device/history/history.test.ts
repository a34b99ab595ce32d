import { describe, expect, it } from "vitest";
import { angleHistory, extentOf, toldRow, verticalRange } from "./history";
import { estimates, START } from "./sample";

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
    const { angles } = angleHistory(estimates([{ t: 0 }]));
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

  it("takes no rows", () => {
    const nothing = angleHistory(estimates([]));
    expect(nothing.time).toEqual([]);
    expect(extentOf(nothing)).toBeNull();
  });
});

describe("verticalRange", () => {
  const range = (rows: Parameters<typeof estimates>[0], span: [number, number] | null = null) =>
    verticalRange(
      angleHistory(estimates(rows)),
      "yaw",
      span && { min: START + span[0], max: START + span[1] },
    );

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

  it("is that of what is looked at", () => {
    const rows = [
      { t: 0, yaw: 10 },
      { t: 50, yaw: 100 },
    ];
    expect(range(rows)[1]).toBeGreaterThan(90);
    expect(range(rows, [0, 20])[1]).toBeLessThan(20);
    expect(range(rows, [20, 30])).toEqual([-2, 2]);
  });
});

describe("toldRow", () => {
  const history = angleHistory(estimates([{ t: -5 }, { t: 0 }, { t: 5 }, { t: 605 }]));
  it("is the one under the cursor", () => expect(toldRow(history, "yaw", 1, null)).toBe(1));
  it("is the last one, when the cursor is in a gap or away", () => {
    expect(history.angles.yaw.value[3]).toBeNull();
    expect(toldRow(history, "yaw", 3, null)).toBe(4);
    expect(toldRow(history, "yaw", null, null)).toBe(4);
  });
  it("is the last one of what is looked at", () =>
    expect(toldRow(history, "yaw", null, { min: START, max: START + 60 })).toBe(2));
});

it("shows a single estimate in the middle", () =>
  expect(extentOf(angleHistory(estimates([{ t: 0 }])))).toEqual({ min: START - 30, max: START + 30 }));
