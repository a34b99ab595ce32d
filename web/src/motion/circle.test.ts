import { expect, test } from "vitest";
import { dotAt, dotsOf, rings } from "./circle";
import { GRAVITY } from "./drive";
import { drive } from "./fixture";

test("braking is down, being accelerated to the left is to the left of the paper", () => {
  const braking = drive({ longitudinal: [-GRAVITY / 2], lateral: [0] }, 1);
  expect(dotAt(braking, 0)).toEqual({ right: -0, up: -0.5 });
  const leftBend = drive({ longitudinal: [0], lateral: [GRAVITY / 4] }, 1);
  expect(dotAt(leftBend, 0)).toEqual({ right: -0.25, up: 0 });
});

test("rows without an acceleration have no dot", () => {
  expect(dotsOf(drive({ lateral: [null, 0, null, 0] }))).toHaveLength(2);
});

test("the rings hold everything, and there are at least two", () => {
  expect(rings([{ right: 0, up: 0.01 }])).toEqual([0.2, 0.4]);
  expect(rings([{ right: 0.3, up: 0.4 }])).toEqual([0.2, 0.4, 0.6]);
  expect(rings([{ right: 0, up: -12 }])).toEqual([3, 5, 10, 20]);
});
