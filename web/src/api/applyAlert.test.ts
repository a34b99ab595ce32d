import { type InfiniteData, QueryClient } from "@tanstack/react-query";
import { beforeEach, describe, expect, it, vi } from "vitest";
import type { AlertPage } from "./alertList";
import { applyAlert } from "./applyAlert";
import { type AlertFilter, keys } from "./keys";
import type { Alert } from "./types";

const filter = (state: AlertFilter["state"]): AlertFilter => ({
  state,
  kind: "",
  severity: "",
  deviceId: "",
  from: "",
  to: "",
});
const [UNRESOLVED, RESOLVED] = [keys.alertList(filter("unresolved")), keys.alertList(filter("resolved"))];

const OPEN = {
  id: 1,
  device_id: "a",
  kind: "gps_lost",
  state: "open",
  opened_at: "2025-11-22T10:00:00Z",
  updated_at: "2025-11-22T10:00:00Z",
} as Alert;
const later = (state: Alert["state"], over: Partial<Alert> = {}): Alert => ({
  ...OPEN,
  state,
  updated_at: "2025-11-22T10:05:00Z",
  ...over,
});

describe("an alert told by the stream", () => {
  const soon = vi.fn();
  let client: QueryClient;
  const states = (key: readonly unknown[]) =>
    client
      .getQueryData<InfiniteData<AlertPage>>(key)
      ?.pages.flatMap(({ items }) => items.map(({ state }) => state));

  beforeEach(() => {
    soon.mockClear();
    client = new QueryClient();
    const page = (items: Alert[]) => ({ pages: [{ items, places: [] }], pageParams: [[]] });
    client.setQueryData(UNRESOLVED, page([OPEN]));
    client.setQueryData(RESOLVED, page([]));
    client.setQueryData(keys.alert(1), OPEN);
  });

  it("changes at once wherever it is shown", () => {
    applyAlert(client, later("acknowledged"), soon);
    expect(states(UNRESOLVED)).toEqual(["acknowledged"]);
    expect(client.getQueryData<Alert>(keys.alert(1))?.state).toBe("acknowledged");
    expect(soon).not.toHaveBeenCalledWith(UNRESOLVED);
    expect(soon).toHaveBeenCalledWith(keys.unread);
  });

  it("has the lists read again which it enters or leaves", () => {
    applyAlert(client, later("resolved"), soon);
    expect(soon).toHaveBeenCalledWith(UNRESOLVED);
    expect(soon).toHaveBeenCalledWith(RESOLVED);
  });

  it("has the list read again in which it is new, and no other", () => {
    applyAlert(client, later("open", { id: 2 }), soon);
    expect(soon).toHaveBeenCalledWith(UNRESOLVED);
    expect(soon).not.toHaveBeenCalledWith(RESOLVED);
  });

  it("does not go back to what an answer has overtaken", () => {
    applyAlert(client, later("acknowledged"), soon);
    applyAlert(client, OPEN, soon);
    expect(states(UNRESOLVED)).toEqual(["acknowledged"]);
    expect(client.getQueryData<Alert>(keys.alert(1))?.state).toBe("acknowledged");
  });
});
