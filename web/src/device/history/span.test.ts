import { describe, expect, it } from "vitest";
import {
  centred,
  held,
  inside,
  lengthOf,
  loadedFor,
  MOST_POINTS,
  moved,
  pointsFor,
  rangeStart,
  stretched,
} from "./span";

const SPAN = { min: 1000, max: 2000 };

describe("stretched", () => {
  it("keeps the moment it is stretched about", () => {
    expect(stretched(SPAN, 0.5, 1200)).toEqual({ min: 1100, max: 1600 });
    expect(stretched(SPAN, 2)).toEqual({ min: 500, max: 2500 });
  });
  it("ends at 20 s", () => expect(lengthOf(stretched(SPAN, 1e-6))).toBeCloseTo(20));
});

it("moves by a share of its length", () => expect(moved(SPAN, -0.5)).toEqual({ min: 500, max: 1500 }));
it("is put around a moment", () => expect(centred(SPAN, 0)).toEqual({ min: -500, max: 500 }));

describe("held", () => {
  it("goes along with one finger", () => {
    // A hundred pixels to the right on a chart of 500: a fifth earlier.
    expect(held(SPAN, [{ time: 1200, x: 200 }], 500)).toEqual({ min: 800, max: 1800 });
  });
  it("keeps two moments under two fingers", () => {
    const span = held(
      SPAN,
      [
        { time: 1200, x: 50 },
        { time: 1400, x: 450 },
      ],
      500,
    );
    expect(span).toEqual({ min: 1175, max: 1425 });
  });
  it("does not turn round when the fingers meet or cross", () => {
    for (const x of [50, 51, 40]) {
      const span = held(
        SPAN,
        [
          { time: 1200, x: 50 },
          { time: 1400, x },
        ],
        500,
      );
      expect(lengthOf(span)).toBeGreaterThan(0);
    }
    const crossed = held(
      SPAN,
      [
        { time: 1200, x: 300 },
        { time: 1400, x: 100 },
      ],
      500,
    );
    expect(lengthOf(crossed)).toBeCloseTo(20);
  });
});

describe("inside", () => {
  const limits = { min: 0, max: 1500 };
  it("leaves alone what fits", () =>
    expect(inside({ min: 10, max: 20 }, limits)).toEqual({ min: 10, max: 20 }));
  it("moves back what has left, as long as before", () => {
    expect(inside(SPAN, limits)).toEqual({ min: 500, max: 1500 });
    expect(inside({ min: -70, max: 30 }, limits)).toEqual({ min: 0, max: 100 });
  });
  it("shows everything when asked for more", () =>
    expect(inside({ min: -9, max: 1e6 }, limits)).toEqual(limits));
  it("bears a history of one moment", () =>
    expect(inside({ min: 0, max: 60 }, { min: 30, max: 30 })).toEqual({ min: 30, max: 50 }));
});

describe("loadedFor", () => {
  it.each([1, 60, 1000, 3601, 86_400, 2_592_000])("has room on both sides of %d s", (length) => {
    const span = { min: 1_763_805_600, max: 1_763_805_600 + length };
    const loaded = loadedFor(span);
    expect(span.min - loaded.min).toBeGreaterThanOrEqual(length / 2);
    expect(loaded.max - span.max).toBeGreaterThanOrEqual(length / 2);
    expect(lengthOf(loaded)).toBeLessThanOrEqual(5 * length);
  });
  it("stays the same for small moves", () => {
    const span = { min: 1_763_805_600, max: 1_763_809_300 };
    expect(loadedFor(moved(span, 0.01))).toEqual(loadedFor(span));
  });
});

describe("pointsFor", () => {
  it("asks for two points a pixel of what is read again and again", () =>
    expect(pointsFor(null, 360)).toBe(1000));
  it("asks for more of what can be zoomed and moved, but not for more than there is", () => {
    expect(pointsFor(SPAN, 360)).toBeGreaterThan(2 * pointsFor(null, 360));
    expect(pointsFor(SPAN, 1280)).toBe(MOST_POINTS);
  });
});

describe("rangeStart", () => {
  it("counts back from the last data, on the minute", () => {
    expect(rangeStart("hour", "2025-11-22T10:00:59Z")).toBe("2025-11-22T09:00:00.000Z");
    expect(rangeStart("hour", "2025-11-22T10:00:01Z")).toBe("2025-11-22T09:00:00.000Z");
    expect(rangeStart("month", "2025-11-22T10:00:01Z")).toBe("2025-10-23T10:00:00.000Z");
  });
  it("has no beginning for everything, or for nothing", () => {
    expect(rangeStart("all", "2025-11-22T10:00:00Z")).toBeNull();
    expect(rangeStart("day", null)).toBeNull();
  });
});
