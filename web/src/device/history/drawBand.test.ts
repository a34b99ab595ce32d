import { expect, it } from "vitest";
import { slices } from "./drawBand";

const EDGES = { low: [1, 0, 2, null, 3, 3], high: [5, 6, 4, null, 7, 8] };

it("takes together what is nearer than can be seen, with all that it spans", () =>
  expect(slices(EDGES, [0, 2], (row) => row, 2)).toEqual([
    [
      { x: 0, low: 0, high: 6 },
      { x: 2, low: 2, high: 4 },
    ],
  ]));

it("is interrupted in a gap", () => {
  const pieces = slices(EDGES, [-1, 9], (row) => 10 * row, 2);
  expect(pieces.map((piece) => piece.map(({ x }) => x))).toEqual([
    [0, 10, 20],
    [40, 50],
  ]);
});

it("begins and ends where it is told, even with a gap", () =>
  expect(slices(EDGES, [3, 4], (row) => row, 2)).toEqual([[{ x: 4, low: 3, high: 7 }]]));
