import { describe, expect, it } from "vitest";
import type { Alert } from "../api/types";
import { isDue, lateText, report } from "./settling";

const OPEN = { id: 1, device_id: "a", state: "open" } as Alert;
const seen = (by: string, note: string | null): Alert => ({
  ...OPEN,
  state: "acknowledged",
  acknowledged_by: by,
  acknowledge_note: note,
});
const over = (by: string, note: string | null): Alert => ({
  ...OPEN,
  state: "resolved",
  resolved_by: by,
  resolve_note: note,
});
const answered = (value: Alert) => ({ item: OPEN, done: true as const, value });

describe("what became of alerts", () => {
  it.each([
    ["acknowledged with our note", "acknowledge", seen("Ann", "on it"), "done"],
    ["acknowledged by somebody else", "acknowledge", seen("Bob", "on it"), "late"],
    ["acknowledged by us before, with another note", "acknowledge", seen("Ann", "later"), "late"],
    ["over meanwhile", "acknowledge", over("service", "GPS fixes come again."), "late"],
    ["resolved with our note", "resolve", over("Ann", "on it"), "done"],
    ["resolved by somebody else", "resolve", over("Bob", null), "late"],
  ] as const)("%s", (_, verb, after, fate) => {
    expect(report([answered(after)], verb, "Ann", "on it")[fate]).toEqual([after]);
  });

  it("takes no note for an empty one", () => {
    expect(report([answered(seen("Ann", null))], "acknowledge", "Ann", "").done).toHaveLength(1);
  });

  it("keeps what failed, to be repeated", () => {
    const error = new Error("no answer");
    const { done, failed } = report([{ item: OPEN, done: false, error }], "resolve", "Ann", "");
    expect([done, failed]).toEqual([[], [{ alert: OPEN, error }]]);
  });

  it("says who was quicker", () => {
    expect(lateText(seen("Bob", null))).toBe("already acknowledged by Bob");
    expect(lateText(over("Bob", null))).toBe("already resolved by Bob");
    expect(lateText(over("service", null))).toBe("already resolved by the service");
  });
});

it("is due as long as it changes something", () => {
  const states = [OPEN, seen("Bob", null), over("Bob", null)];
  expect(states.map((alert) => isDue(alert, "acknowledge"))).toEqual([true, false, false]);
  expect(states.map((alert) => isDue(alert, "resolve"))).toEqual([true, true, false]);
});
