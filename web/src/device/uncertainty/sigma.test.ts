import { describe, expect, it } from "vitest";
import type { Estimates } from "../../api/types";
import { installation, mount } from "../fixture";
import { calibrationRange, sigmaHistory, sigmaLimits, sigmaRange, sigmaShare } from "./sigma";

const LIMITS = sigmaLimits({ yaw_sigma_deg: 1.8, tilt_sigma_deg: 1.4 });

it("keeps every bar and every mark on its scale, in order", () => {
  expect(LIMITS).toEqual([1.4, 1.4, 1.8]);
  const shares = [0.01, 0.5, ...LIMITS, 5, 90].map(sigmaShare);
  expect(shares).toEqual(shares.toSorted((a, b) => a - b));
  expect(Math.min(...shares)).toBeGreaterThan(0);
  expect(Math.max(...shares)).toBe(1);
});

describe("the calibration looked at", () => {
  it("is the one that led to the mounting in force", () =>
    expect(calibrationRange(installation({ mount: mount("in_force") }))).toEqual({
      from: "2025-11-22T09:10:00.000Z",
      to: "2025-11-22T09:42:00.000Z",
    }));

  it("is the present one otherwise, in a window that stays for a minute", () => {
    const range = calibrationRange(installation({ mount: mount("suspect") }));
    expect(range).toEqual({ from: "2025-11-22T09:31:00.000Z", to: null });
    const later = installation({ last_data_at: "2025-11-22T10:01:40Z" });
    expect(calibrationRange(later)).toEqual(range);
  });

  it("is all there is before the first data", () =>
    expect(calibrationRange(installation({ last_data_at: null }))).toEqual({ from: null, to: null }));
});

describe("the lines", () => {
  const at = (second: number) => new Date(1_763_805_600_000 + 1000 * second).toISOString();
  const estimates = {
    time: [at(0), at(2), at(300)],
    sigma_deg: [
      [8, 9, 30],
      [1, 2, 3],
      [0.5, 0.6, 0.7],
    ],
  } as Estimates;

  it("are interrupted where nothing came", () => {
    const { time, sigma } = sigmaHistory(estimates);
    expect(sigma[2]).toEqual([30, 3, null, 0.7]);
    expect(time).toEqual(time.toSorted((a, b) => a - b));
  });

  it("lie within the axis, the limits too", () => {
    const [least, most] = sigmaRange(sigmaHistory(estimates), LIMITS);
    expect(least).toBeLessThan(0.5);
    expect(least).toBeGreaterThan(0);
    expect(most).toBeGreaterThan(30);
    const [, above] = sigmaRange({ time: [0], sigma: [[0.3], [0.3], [0.3]] }, LIMITS);
    expect(above).toBeGreaterThan(1.8);
  });
});
