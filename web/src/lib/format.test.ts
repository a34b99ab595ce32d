import { expect, it } from "vitest";
import { fixed } from "./format";

it.each([
  [-94.04, 1, "\u221294.0"],
  [-0.04, 1, "0.0"],
  [7.25, 0, "7"],
])("%d to %d digits: %s", (value, digits, text) => expect(fixed(value, digits)).toBe(text));
