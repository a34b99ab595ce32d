import { describe, expect, it } from "vitest";
import { frame, line } from "./drawing";

describe.each([
  [40, 52],
  [120, 130],
  [40, 3],
  [41.5, 0],
])("a test of %d s up to %d km/h", (seconds, most) => {
  const { x, y, left, right, bottom, times, speeds } = frame(seconds, most);

  it("lies within its frame", () => {
    expect([x(0), x(seconds)]).toEqual([left, right]);
    expect(y(0)).toBe(bottom);
    expect(y(most)).toBeGreaterThanOrEqual(0);
  });

  it("has a few round numbers at its axes, the last above the curve", () => {
    expect(times.at(-1)).toBeLessThanOrEqual(seconds);
    expect(times.length).toBeLessThanOrEqual(7);
    expect(speeds.length).toBeLessThanOrEqual(6);
    expect(speeds.at(-1)).toBeGreaterThanOrEqual(most);
  });
});

it("draws a line through its points", () => {
  const drawn = frame(40, 40);
  expect(line(drawn, [0, 40], [0, 40])).toBe(`M${drawn.left}.00 ${drawn.bottom}.00L${drawn.right}.00 5.00`);
});
