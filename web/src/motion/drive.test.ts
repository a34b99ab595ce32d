import { expect, test } from "vitest";
import { angles } from "../lib/rotation";
import { reach, rowAt, tilt } from "./drive";
import { drive } from "./fixture";

test("the row of a moment is the nearest one, also beyond both ends", () => {
  const time = [10, 11, 13];
  expect([0, 10.4, 10.6, 11.9, 12.1, 99].map((moment) => rowAt(time, moment))).toEqual([0, 0, 1, 1, 2, 2]);
  expect(rowAt([5], 7)).toBe(0);
});

test("tilt is drawn larger about the same axes, and without the heading", () => {
  const seen = angles(tilt(drive({ roll: [2], pitch: [-3], heading: [90] }, 1), 0, 5));
  expect(seen.roll).toBeCloseTo(10);
  expect(seen.pitch).toBeCloseTo(-15);
  expect(seen.yaw).toBeCloseTo(0);
});

test("what is not known does not count for the reach of a chart", () => {
  expect(reach([null, 3, -1], [null, null, 7])).toEqual([-1, 7]);
  expect(reach([null], [])).toBeNull();
});
