import { expect, it } from "vitest";
import { apart } from "./apart";

it.each([
  [
    [50, 10],
    [50, 10],
  ],
  [
    [10, 12],
    [10, 24],
  ],
  [
    [12, 10, 11],
    [38, 10, 24],
  ],
  [
    [95, 95],
    [86, 100],
  ],
])("%j: %j", (wanted, places) => expect(apart(wanted, 14, 100)).toEqual(places));
