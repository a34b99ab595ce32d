import { describe, expect, it } from "vitest";
import { turnBetween, unwrap, wrap } from "./angles";

describe("wrap", () => {
  it.each([
    [0, 0],
    [180, 180],
    [-180, 180],
    [181, -179],
    [-541, 179],
    [720, 0],
  ])("%d is %d", (given, expected) => expect(wrap(given)).toBeCloseTo(expected, 9));
});

describe("turnBetween", () => {
  it("takes the short way round", () => {
    expect(turnBetween(179, -179)).toBe(2);
    expect(turnBetween(-179, 179)).toBe(-2);
  });
});

describe("unwrap", () => {
  it("draws no jump at 180 degrees", () => {
    const curve = unwrap([178, 179, -179, -178, 179]);
    for (let i = 1; i < curve.length; i++)
      expect(Math.abs((curve[i] ?? 0) - (curve[i - 1] ?? 0))).toBeLessThan(4);
  });

  it("keeps every value the same direction", () => {
    const given = [170, -170, -150, 150, 100, -100];
    unwrap(given).forEach((value, i) => {
      expect(wrap(value ?? Number.NaN)).toBeCloseTo(given[i] ?? Number.NaN, 9);
    });
  });

  it("ends in the usual range, so that the axis shows usual numbers", () => {
    expect(unwrap([170, -170, -90, 0, 90]).at(-1)).toBeCloseTo(90);
  });

  it("keeps gaps and goes on after them without a jump", () => {
    expect(unwrap([179, null, Number.NaN, -179])).toEqual([-181, null, null, -179]);
  });

  it("takes an empty curve", () => expect(unwrap([])).toEqual([]));
});
