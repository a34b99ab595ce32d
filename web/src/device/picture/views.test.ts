import { describe, expect, it } from "vitest";
import { dot, type Vector } from "../../lib/rotation";
import { drawn, VIEWS } from "./views";

const FORWARD: Vector = [1, 0, 0];
const LEFT: Vector = [0, 1, 0];
const UP: Vector = [0, 0, 1];
const [above, side, behind] = VIEWS;
if (!above || !side || !behind) throw new Error("three views");

describe("views", () => {
  it.each(VIEWS)("$name: right, up and toward are a right-handed frame", ({ right, up, toward }) => {
    const [a, b, c] = right;
    const [d, e, f] = up;
    const cross: Vector = [b * f - c * e, c * d - a * f, a * e - b * d];
    expect(dot(cross, toward)).toBe(1);
  });

  it("shows left on the left from above and from behind", () => {
    expect(drawn(above, LEFT)).toMatchObject({ right: -1 });
    expect(drawn(behind, LEFT)).toMatchObject({ right: -1 });
  });

  it("shows forward up from above, and to the left for somebody standing at the vehicle's left", () => {
    expect(drawn(above, FORWARD)).toMatchObject({ up: 1 });
    expect(drawn(side, FORWARD)).toMatchObject({ right: -1 });
  });

  it("says what points at the reader", () => {
    expect(drawn(above, UP)).toMatchObject({ depth: 1, foreshortened: true });
    expect(drawn(side, LEFT)).toMatchObject({ depth: 1, foreshortened: true });
    expect(drawn(behind, FORWARD)).toMatchObject({ depth: -1, foreshortened: true });
  });
});
