import { expect, test } from "vitest";
import { around, moved, rangeOf, readView, type View, writeView } from "./window";

const LAST = "2026-01-02T10:00:00Z";
const last = Date.parse(LAST) / 1000;

test("what is looked at comes back from the address", () => {
  const views: View[] = [
    { length: 600, end: null },
    { length: 21_600, end: last },
  ];
  for (const view of views) expect(readView(writeView(view).toString())).toEqual(view);
});

test("nonsense in the address shows the last minutes", () => {
  expect(readView("length=7&end=never")).toEqual({ length: 600, end: null });
});

test("the last data are followed until somebody moves back", () => {
  const latest = readView("");
  expect(rangeOf(latest, LAST)).toEqual({ from: "2026-01-02T09:50:00.000Z", to: "2026-01-02T10:00:00.000Z" });
  expect(rangeOf(latest, null)).toBeNull();
  const back = moved(latest, -1, LAST);
  expect(back.end).toBe(last - 300);
  expect(moved(back, 1, LAST)).toEqual(latest);
});

test("a moment is in the middle of what is shown around it", () => {
  expect(rangeOf(around(last), null)?.from).toBe("2026-01-02T09:55:00.000Z");
});

test("a long view moves on with the minutes, not with every chunk", () => {
  const long = readView("length=3600");
  expect(rangeOf(long, "2026-01-02T10:00:01Z")).toEqual(rangeOf(long, "2026-01-02T10:00:59Z"));
  expect(rangeOf(long, "2026-01-02T10:00:01Z")?.to).toBe("2026-01-02T10:01:00.000Z");
});
