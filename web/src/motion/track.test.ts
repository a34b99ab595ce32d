import { expect, test } from "vitest";
import { drive } from "./fixture";
import { barOf, placeAt, trackOf } from "./track";

test("north is up", () => {
  expect(placeAt(drive({ east: [3], north: [4] }, 1), 0)).toEqual({ x: 3, y: -4 });
});

test("what was carried on without a fix is drawn apart, and joins what was measured", () => {
  const track = trackOf(drive({ east: [0, 10, 20, 30], reckoned: [false, false, true, false] }));
  expect(track?.measured).toBe("M0.0 0.0L10.0 0.0M20.0 0.0L30.0 0.0");
  expect(track?.reckoned).toBe("M10.0 0.0L20.0 0.0");
});

test("no line leads over rows without a position", () => {
  expect(trackOf(drive({ east: [0, null, 20, 30] }))?.measured).toBe("M20.0 0.0L30.0 0.0");
});

test("without any position there is no map", () => {
  expect(trackOf(drive({ east: [null, null, null, null] }))).toBeNull();
});

test("the map is square, holds the way with a margin, and has a size even where nobody moved", () => {
  const [x, y, width, height] = trackOf(drive({ east: [0, 100, 100, 0], north: [0, 0, 50, 50] }))?.box ?? [];
  expect(width).toBe(height);
  expect(x).toBeLessThan(0);
  expect((y ?? 0) + (height ?? 0)).toBeGreaterThan(0);
  expect(trackOf(drive())?.box[2]).toBeGreaterThan(10);
});

test("the bar of the scale is round and not longer than a quarter", () => {
  expect([100, 900, 7000].map(barOf)).toEqual([20, 200, 1000]);
});
