import { expect, it } from "vitest";
import { labelled, shortened } from "./evidence";
import { sigmaLimits, sigmaShare } from "./sigma";

it.each([
  ["angle_deg", { label: "angle", unit: "°" }],
  ["speed_error_mps", { label: "speed error", unit: " m/s" }],
  ["reason", { label: "reason", unit: "" }],
  ["s", { label: "s", unit: "" }],
])("%s is labelled", (name, expected) => expect(labelled(name)).toEqual(expected));

it.each([
  [83.21745, "83.22"],
  [[0.1234567, 2], "0.1235, 2"],
  ["gyroscope", "gyroscope"],
  [true, "true"],
  [{ a: 1 }, '{"a":1}'],
])("%o is shortened", (value, expected) => expect(shortened(value)).toBe(expected));

it("keeps every bar and every mark on its scale, in order", () => {
  const limits = sigmaLimits({ yaw_sigma_deg: 1.8, tilt_sigma_deg: 1.4 });
  expect(limits).toEqual([1.4, 1.4, 1.8]);
  const shares = [0.01, 0.5, ...limits, 5, 90].map(sigmaShare);
  expect(shares).toEqual(shares.toSorted((a, b) => a - b));
  expect(Math.min(...shares)).toBeGreaterThan(0);
  expect(Math.max(...shares)).toBe(1);
});
