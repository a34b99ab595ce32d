import { describe, expect, it } from "vitest";
import { each } from "./each";

const soon = () => new Promise<void>((resolve) => setTimeout(resolve));

describe("each", () => {
  it("gives what became of each, in their order, though some fail", async () => {
    const outcomes = await each([3, 1, 2], 2, async (n) => {
      for (let turn = 0; turn < n; turn++) await soon();
      if (n === 1) throw new Error("refused");
      return n * 10;
    });
    expect(outcomes).toEqual([
      { item: 3, done: true, value: 30 },
      { item: 1, done: false, error: new Error("refused") },
      { item: 2, done: true, value: 20 },
    ]);
  });

  it.each([1, 4])("never does more than %i at once, and as many when there are", async (atOnce) => {
    let running = 0;
    const seen: number[] = [];
    await each([...Array(9).keys()], atOnce, async () => {
      seen.push(++running);
      await soon();
      running--;
    });
    expect(seen).toHaveLength(9);
    expect(Math.max(...seen)).toBe(atOnce);
  });

  it("has nothing to do with nothing", async () => expect(await each([], 4, soon)).toEqual([]));
});
