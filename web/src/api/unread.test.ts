import { describe, expect, it } from "vitest";
import { titled } from "../app/title";
import type { Alert, Page } from "./types";
import { openedAfter } from "./unread";

const opened = (...times: string[]) =>
  ({ items: times.map((opened_at) => ({ opened_at })), next_cursor: null }) as Page<Alert>;

describe("what is unread", () => {
  const page = opened("2025-11-22T10:02:00.5Z", "2025-11-22T10:02:00Z", "2025-11-22T10:01:00.250Z");

  it("is everything before the first look", () => expect(openedAfter(page, null)).toHaveLength(3));

  it("is what was opened later than the newest that was seen", () => {
    expect(openedAfter(page, "2025-11-22T10:02:00.000Z")).toEqual([page.items[0]]);
    expect(openedAfter(page, "2025-11-22T10:02:00.500000Z")).toEqual([]);
  });
});

describe("the title of a page", () => {
  it.each([
    [0, "Alerts · Livella"],
    [3, "(3) Alerts · Livella"],
    [99, "(99) Alerts · Livella"],
    [100, "(99+) Alerts · Livella"],
  ])("with %i unread", (unread, title) => expect(titled("Alerts", unread)).toBe(title));
});
