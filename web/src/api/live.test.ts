import { type InfiniteData, QueryClient } from "@tanstack/react-query";
import { beforeEach, describe, expect, it, vi } from "vitest";
import { apply } from "./apply";
import { type DeviceFilter, keys } from "./keys";
import type { Alert, Device, Installation, Page } from "./types";

const installation = (over: Partial<Installation> = {}): Installation => ({
  device_id: "a",
  stage: "settling",
  since: "2025-11-22T10:00:00Z",
  progress: 0.5,
  needs: ["turn"],
  hint: "Turn a few corners.",
  estimate: null,
  verification: { state: "idle", elapsed_s: 0, duration_s: 40, error_mps: null, limit_mps: 2.5, trace: null },
  mount: null,
  limits: { yaw_sigma_deg: 1.8, tilt_sigma_deg: 1.4 },
  open_alerts: 0,
  last_data_at: "2025-11-22T10:01:00Z",
  data: null,
  revision: 7,
  ...over,
});

const device = (over: Partial<Device> = {}): Device => ({
  id: "a",
  name: "Van 1",
  vehicle: null,
  notes: null,
  accelerometer_calibration: null,
  vehicle_class: null,
  created_at: "2025-11-22T09:00:00Z",
  stage: "settling",
  progress: 0.5,
  mount_status: null,
  open_alerts: 0,
  last_data_at: null,
  revision: 7,
  ...over,
});

const alert = (over: Partial<Alert> = {}): Alert => ({
  id: 1,
  device_id: "a",
  kind: "gps_lost",
  severity: "warning",
  state: "open",
  opened_at: "2025-11-22T10:00:00Z",
  updated_at: "2025-11-22T10:00:00Z",
  count: 1,
  message: "No GPS fix for 5 minutes.",
  data: {},
  acknowledged_at: null,
  acknowledged_by: null,
  acknowledge_note: null,
  resolved_at: null,
  resolved_by: null,
  resolve_note: null,
  ...over,
});

const EVERYTHING: DeviceFilter = {
  q: "",
  stage: "",
  alert_severity: "",
  alert_kind: "",
  mount_status: "",
  sort: "id",
};
const LIST = keys.deviceList(EVERYTHING);
let client: QueryClient;
let soon: ReturnType<typeof vi.fn<(key: readonly unknown[]) => void>>;

beforeEach(() => {
  client = new QueryClient();
  soon = vi.fn();
  client.setQueryData(keys.installation("a"), installation());
  client.setQueryData(keys.device("a"), device());
  client.setQueryData(LIST, {
    pages: [{ items: [device({ id: "b" }), device()], next_cursor: null }],
    pageParams: [null],
  } satisfies InfiniteData<Page<Device>, null>);
});

const known = () => client.getQueryData<Installation>(keys.installation("a"));
const rows = () =>
  client.getQueryData<InfiniteData<Page<Device>>>(LIST)?.pages.flatMap((page) => page.items) ?? [];

describe("an installation event", () => {
  const told = installation({ stage: "verifying", progress: 0.8, revision: 8 });

  it("changes the device's page and its row, and no other row", () => {
    const other = rows()[0];
    apply(client, { type: "installation", data: told }, soon);
    expect(known()).toEqual(told);
    expect(client.getQueryData<Device>(keys.device("a"))?.stage).toBe("verifying");
    expect(rows()[1]).toMatchObject({
      id: "a",
      name: "Van 1",
      stage: "verifying",
      progress: 0.8,
      revision: 8,
    });
    expect(rows()[0]).toBe(other);
  });

  it("does not go back when it comes late", () => {
    const late = installation({ stage: "waiting", revision: 6 });
    const before = rows();
    apply(client, { type: "installation", data: late }, soon);
    expect(known()?.stage).toBe("settling");
    expect(rows()).toEqual(before);
  });

  it("takes another count of alerts at the same revision", () => {
    apply(client, { type: "installation", data: installation({ open_alerts: 2 }) }, soon);
    expect(known()?.open_alerts).toBe(2);
    expect(rows()[1]?.open_alerts).toBe(2);
  });

  it("reads the mountings again only when there is another", () => {
    apply(client, { type: "installation", data: told }, soon);
    expect(soon).not.toHaveBeenCalledWith(keys.mounts("a"));
    const mount = { id: 1, status: "in_force" } as Installation["mount"];
    apply(
      client,
      { type: "installation", data: installation({ stage: "confirmed", mount, revision: 9 }) },
      soon,
    );
    expect(soon).toHaveBeenCalledWith(keys.mounts("a"));
  });

  it("reads the mountings again when the time of the last one is known better", () => {
    const mount = (time: string) =>
      ({ id: 1, status: "in_force", confirmed_at: time }) as Installation["mount"];
    client.setQueryData(keys.installation("a"), installation({ mount: mount("2025-11-22T10:02:00Z") }));
    const told = installation({ mount: mount("2025-11-22T10:00:00Z"), revision: 8 });
    apply(client, { type: "installation", data: told }, soon);
    expect(soon).toHaveBeenCalledWith(keys.mounts("a"));
  });

  it("does not fill the cache with devices that nobody looks at", () => {
    apply(client, { type: "installation", data: installation({ device_id: "z" }) }, soon);
    expect(client.getQueryData(keys.installation("z"))).toBeUndefined();
    expect(client.getQueryData(keys.device("z"))).toBeUndefined();
  });
});

describe("an alert event", () => {
  const alerts = () => client.getQueryData<Page<Alert>>(keys.alerts("a"))?.items ?? [];
  beforeEach(() => client.setQueryData(keys.alerts("a"), { items: [alert()], next_cursor: null }));

  it("adds a new alert on top", () => {
    apply(client, { type: "alert", data: alert({ id: 2 }) }, soon);
    expect(alerts().map(({ id }) => id)).toEqual([2, 1]);
  });

  it("changes a known alert in place and does not go back", () => {
    apply(client, { type: "alert", data: alert({ count: 3, updated_at: "2025-11-22T10:05:00Z" }) }, soon);
    apply(client, { type: "alert", data: alert({ count: 2, updated_at: "2025-11-22T10:04:00Z" }) }, soon);
    expect(alerts()).toHaveLength(1);
    expect(alerts()[0]?.count).toBe(3);
  });
});

describe("a device event", () => {
  it("renames the row and reads the list again", () => {
    const told = device({ name: "Van 9" });
    apply(client, { type: "device", data: { device_id: "a", change: "edited", device: told } }, soon);
    expect(rows()[1]?.name).toBe("Van 9");
    expect(soon).toHaveBeenCalledWith(keys.devices);
  });

  it("reads the list again when a device was removed", () => {
    apply(client, { type: "device", data: { device_id: "a", change: "removed", device: null } }, soon);
    expect(soon).toHaveBeenCalledWith(keys.devices);
  });
});
