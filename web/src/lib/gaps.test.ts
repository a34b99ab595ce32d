import { expect, it } from "vitest";
import { broken, brokenTime, gaps, median } from "./gaps";

it("breaks a line in a long silence and between groups, not at short ones", () => {
  expect([...gaps([0, 5, 10, 70, 75])]).toEqual([]);
  expect([...gaps([0, 5, 10, 71, 76])]).toEqual([3]);
  expect([...gaps([0, 5, 10], ["a", "a", "b"])]).toEqual([2]);
});

it("puts an empty row into the middle of a gap", () => {
  expect(broken([1, 2], new Set([1]))).toEqual([1, null, 2]);
  expect(brokenTime([10, 20], new Set([1]))).toEqual([10, 15, 20]);
});

it("knows no median of nothing", () => {
  expect(median([])).toBeNull();
  expect(median([3, 1, 2])).toBe(2);
});
