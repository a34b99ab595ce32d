import { expect, it } from "vitest";
import { valueText } from "./thresholds";

it.each([
  [16_777_216, "bytes", "16,777,216 bytes"],
  [1.3, "deg", "1.3°"],
  [0.091673, "deg/s", "0.09167 °/s"],
  [15, "m2/s3", "15 m²/s³"],
  [120, "1/min", "120 1/min"],
  [4, "", "4"],
  ["infinite", "s", "unlimited"],
] as const)("%s %s is written %s", (value, unit, text) => expect(valueText({ value, unit })).toBe(text));
