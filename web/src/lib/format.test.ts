import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { setLanguage } from "../text";
import { degreesText, fixed, listed, percent, whole } from "./format";
import { ago, onTheClock } from "./time";

it.each([
  [-94.04, 1, "\u221294.0"],
  [-0.04, 1, "0.0"],
  [7.25, 0, "7"],
])("%d to %d digits: %s", (value, digits, text) => expect(fixed(value, digits)).toBe(text));

it.each([
  [3.44, "3.4°"],
  [9.96, "10°"],
  [-94.4, "\u221294°"],
])("%d degrees: %s", (value, text) => expect(degreesText(value)).toBe(text));

it("gives shares in per cent", () => expect(percent(0.424)).toBe("42%"));

it("groups what is large", () => expect(whole(12_345)).toBe("12,345"));

describe("in Italian", () => {
  beforeAll(() => setLanguage("it"));
  afterAll(() => setLanguage("en"));

  it("has a comma before decimals and a point between thousands", () => {
    expect(fixed(-94.04, 1)).toBe("\u221294,0");
    expect(whole(12_345)).toBe("12.345");
  });

  it("lists and tells the time", () => {
    const then = new Date("2025-11-22T10:00:00Z");
    expect(listed(["a", "b", "c"])).toBe("a, b e c");
    expect(ago(then, new Date(then.getTime() + 180_000))).toBe("3 minuti fa");
    expect(onTheClock(then)).toContain("22 nov 2025");
  });
});
