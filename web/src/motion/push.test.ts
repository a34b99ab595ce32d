import { expect, test } from "vitest";
import { oClock, origin, sideOf } from "./push";

test("sides are told by the nearest of eight, on both ways round", () => {
  expect([0, 20, 45, 90, 160, 180, -180, -90, -44, -21].map(sideOf)).toEqual([
    "front",
    "front",
    "front_left",
    "left",
    "rear",
    "rear",
    "rear",
    "right",
    "front_right",
    "front",
  ]);
});

test("the left is nine o'clock, the right three", () => {
  expect([0, 90, -90, 180, -30, 14].map(oClock)).toEqual([12, 9, 3, 6, 1, 12]);
});

test("the arrow begins on the side from which the push came", () => {
  expect(origin(0).y).toBeCloseTo(-1);
  expect(origin(90).x).toBeCloseTo(-1);
  expect(origin(-90).x).toBeCloseTo(1);
});
