import { describe, expect, it } from "vitest";
import { ago, duration, tickTimes } from "./time";

const NOW = new Date("2025-11-22T10:00:00Z");
const before = (seconds: number) => ago(new Date(NOW.getTime() - seconds * 1000), NOW);

describe("ago", () => {
  it.each([
    [-30, "just now"],
    [4, "just now"],
    [25, "25 seconds ago"],
    [60, "1 minute ago"],
    [3599, "59 minutes ago"],
    [7200, "2 hours ago"],
    [86_400 * 3, "3 days ago"],
    [86_400 * 400, "1 year ago"],
  ])("%d s: %s", (seconds, words) => expect(before(seconds)).toBe(words));
});

describe("duration", () => {
  it.each([
    [0, "0 s"],
    [39.9, "39 s"],
    [240, "4 min"],
    [7500, "2 h 5 min"],
  ])("%d s: %s", (seconds, words) => expect(duration(seconds)).toBe(words));
});

describe("tickTimes", () => {
  const NOON = Date.parse("2025-11-22T12:00:05") / 1000;
  const MIDNIGHT = Date.parse("2025-11-22T00:00:00") / 1000;
  it.each([
    [NOON, 5, "12:00:05"],
    [NOON, 300, "12:00"],
    [MIDNIGHT, 3600, "22 Nov"],
    [MIDNIGHT, 86_400, "22 Nov"],
    [MIDNIGHT, 30 * 86_400, "Nov 2025"],
  ])("%d in steps of %d s: %s", (tick, step, text) => expect(tickTimes([tick], step)).toEqual([text]));
});
