import { describe, expect, it } from "vitest";
import { angles, deviceAxes, fromAngles, matrix, type Quaternion, toQuaternion } from "./rotation";

const QUARTER = Math.SQRT1_2;

describe("matrix", () => {
  it("turns device x to vehicle left for a quarter turn to the left", () => {
    const [x] = deviceAxes([QUARTER, 0, 0, QUARTER]);
    expect(x[0]).toBeCloseTo(0);
    expect(x[1]).toBeCloseTo(1);
  });

  it("has the device axes as its columns", () => {
    const q = fromAngles({ roll: 20, pitch: -35, yaw: 110 });
    const rows = matrix(q);
    const columns = deviceAxes(q);
    for (const i of [0, 1, 2] as const)
      for (const j of [0, 1, 2] as const) expect(columns[j][i]).toBe(rows[i][j]);
  });
});

describe("angles", () => {
  it.each([
    { roll: 0, pitch: 0, yaw: 0 },
    { roll: 3, pitch: 8, yaw: -94 },
    { roll: -179, pitch: -60, yaw: 179.5 },
    { roll: 90, pitch: 89, yaw: -90 },
  ])("gives back %o", (given) => {
    const found = angles(fromAngles(given));
    expect(found.roll).toBeCloseTo(given.roll, 6);
    expect(found.pitch).toBeCloseTo(given.pitch, 6);
    expect(found.yaw).toBeCloseTo(given.yaw, 6);
  });

  it("puts everything into yaw where roll and yaw are not told apart", () => {
    const found = angles(fromAngles({ roll: 0, pitch: 90, yaw: 30 }));
    expect(found.roll).toBe(0);
    expect(found.pitch).toBeCloseTo(90);
    expect(found.yaw).toBeCloseTo(30);
  });

  it("agrees for q and -q", () => {
    const q = fromAngles({ roll: 10, pitch: 20, yaw: 30 });
    const negative = q.map((value) => -value) as unknown as Quaternion;
    expect(angles(negative).yaw).toBeCloseTo(angles(q).yaw, 9);
  });
});

describe("toQuaternion", () => {
  it("scales to unit length", () => expect(toQuaternion([2, 0, 0, 0])).toEqual([1, 0, 0, 0]));
  it.each([[[]], [[0, 0, 0, 0]], [[1, 0, 0]], [[Number.NaN, 0, 0, 1]]])("refuses %o", (values) => {
    expect(() => toQuaternion(values)).toThrow("not a quaternion");
  });
});
