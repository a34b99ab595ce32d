import { type InfiniteData, QueryClient } from "@tanstack/react-query";
import { beforeEach, describe, expect, it, vi } from "vitest";
import { alertInLists, deviceInLists, installationInLists } from "./deviceLists";
import { rowsOf } from "./devices";
import { type DeviceFilter, keys } from "./keys";
import type { Alert, Device, DeviceChange, Installation, Page, Stage } from "./types";

const EVERYTHING: DeviceFilter = {
  q: "",
  stage: "",
  alert_severity: "",
  alert_kind: "",
  mount_status: "",
  sort: "id",
};

const row = (id: string, stage: Stage = "settling"): Device => ({
  id,
  name: `Van ${id}`,
  vehicle: null,
  notes: null,
  accelerometer_calibration: null,
  vehicle_class: null,
  created_at: "2025-11-22T09:00:00Z",
  stage,
  progress: 0.5,
  mount_status: null,
  open_alerts: 0,
  last_data_at: "2025-11-22T10:00:00Z",
  revision: 7,
});

const told = (device_id: string, stage: Stage) =>
  ({
    device_id,
    stage,
    progress: 0.6,
    mount: null,
    open_alerts: 0,
    last_data_at: "2025-11-22T10:01:00Z",
    revision: 8,
  }) as Installation;

let client: QueryClient;
let soon: ReturnType<typeof vi.fn<(key: readonly unknown[]) => void>>;

beforeEach(() => {
  client = new QueryClient();
  soon = vi.fn();
});

function cached(over: Partial<DeviceFilter>, items: Device[], goesOn = false) {
  const key = keys.deviceList({ ...EVERYTHING, ...over });
  const pages = [{ items, next_cursor: goesOn ? "more" : null }];
  client.setQueryData<InfiniteData<Page<Device>>>(key, { pages, pageParams: [null] });
  return key;
}

const readAgain = () => soon.mock.calls.map(([key]) => key);

describe("a list of one stage", () => {
  beforeEach(() => void cached({ stage: "waiting" }, []));

  it("is read again when a device enters or leaves it", () => {
    const left = cached({ stage: "settling" }, [row("a")]);
    const entered = cached({ stage: "verifying" }, []);
    installationInLists(client, told("a", "verifying"), soon);
    expect(readAgain()).toEqual([left, entered]);
  });

  it("is not read again for a device that stays in it", () => {
    cached({ stage: "verifying" }, [row("a", "verifying")]);
    installationInLists(client, told("a", "verifying"), soon);
    expect(soon).not.toHaveBeenCalled();
  });

  it.each([
    ["id", "c", false],
    ["id", "a", true],
    ["-id", "a", false],
    ["-id", "c", true],
    ["last_data_at", "c", false],
    ["-last_data_at", "c", true],
    ["name", "c", true],
  ] as const)("by %s that goes on below b counts %s as read: %s", (sort, id, isRead) => {
    const key = cached({ stage: "verifying", sort }, [row("b", "verifying")], true);
    installationInLists(client, told(id, "verifying"), soon);
    expect(readAgain()).toEqual(isRead ? [key] : []);
  });
});

it("a list of suspect mountings is read again when a mounting becomes suspect, or is confirmed anew", () => {
  const mount = (status: string) => ({ status }) as Installation["mount"];
  const suspect = cached({ mount_status: "suspect" }, []);
  installationInLists(client, { ...told("a", "confirmed"), mount: mount("suspect") }, soon);
  expect(readAgain()).toEqual([suspect]);
  soon.mockClear();
  cached({ mount_status: "suspect" }, [row("a")]);
  installationInLists(client, { ...told("b", "confirmed"), mount: mount("in_force") }, soon);
  expect(soon).not.toHaveBeenCalled();
  installationInLists(client, { ...told("a", "confirmed"), mount: mount("in_force") }, soon);
  expect(readAgain()).toEqual([suspect]);
});

describe("a list by the time of the last data", () => {
  it.each(["last_data_at", "-last_data_at"] as const)("is read again when a row of it sends: %s", (sort) => {
    const key = cached({ sort }, [row("a")]);
    installationInLists(client, told("a", "settling"), soon);
    expect(readAgain()).toEqual([key]);
    installationInLists(client, { ...told("a", "settling"), revision: 9 }, soon);
    expect(soon).toHaveBeenCalledOnce();
  });

  it("begins with one that just sent, but does not end there", () => {
    const newest = cached({ sort: "-last_data_at" }, [row("a")], true);
    cached({ sort: "last_data_at" }, [row("a")], true);
    installationInLists(client, told("z", "settling"), soon);
    expect(readAgain()).toEqual([newest]);
  });
});

it("a list of everything by id is never read again because devices send", () => {
  cached({}, [row("a"), row("b")], true);
  for (const id of ["a", "aa", "z"]) installationInLists(client, told(id, "confirmed"), soon);
  expect(soon).not.toHaveBeenCalled();
});

describe("a list by alert", () => {
  const alert = (over: Partial<Alert>) =>
    ({ id: 1, device_id: "a", kind: "device_silent", severity: "warning", state: "open", ...over }) as Alert;

  it("is read again when a device comes into it or leaves it", () => {
    const silent = cached({ alert_kind: "device_silent" }, []);
    const warned = cached({ alert_severity: "warning" }, [row("b")]);
    cached({ alert_severity: "critical" }, []);
    cached({ alert_kind: "gps_lost" }, [row("a")]);
    cached({}, [row("a")]);
    alertInLists(client, alert({}), soon);
    expect(readAgain()).toEqual([silent, warned]);
    soon.mockClear();
    alertInLists(client, alert({ device_id: "b", state: "resolved" }), soon);
    expect(readAgain()).toEqual([warned]);
  });

  it("is read again when an alert in it becomes more severe", () => {
    const warned = cached({ alert_severity: "warning" }, [row("a")]);
    const critical = cached({ alert_severity: "critical" }, []);
    alertInLists(client, alert({ severity: "critical" }), soon);
    expect(readAgain()).toEqual([warned, critical]);
  });

  it("stays as it is while an alert in it is counted once more", () => {
    cached({ alert_kind: "device_silent" }, [row("a")]);
    alertInLists(client, alert({ count: 2, state: "acknowledged" }), soon);
    expect(soon).not.toHaveBeenCalled();
  });
});

it("a device that is renamed has its new name at once, in every list", () => {
  const lists = [cached({}, [row("b"), row("a")]), cached({ sort: "name" }, [row("a"), row("b")])];
  const change = { device_id: "a", change: "edited", device: { ...row("a"), name: "Bus" } } as DeviceChange;
  deviceInLists(client, change, soon);
  for (const key of lists) {
    const { pages } = client.getQueryData<InfiniteData<Page<Device>>>(key) ?? { pages: [] };
    expect(rowsOf(pages).find(({ id }) => id === "a")?.name).toBe("Bus");
  }
  expect(readAgain()).toEqual([keys.devices]);
});

it("a device that moved from one page to another between two readings is listed once", () => {
  const page = (...items: Device[]) => ({ items, next_cursor: null });
  expect(rowsOf([page(row("a"), row("b")), page(row("a"), row("c"))]).map(({ id }) => id)).toEqual([
    "a",
    "b",
    "c",
  ]);
});

/** Devices in the largest list anybody has had, and events a second of a busy fleet. */
const FLEET = 10_000;
const EVENTS = 100;

it("ten thousand rows take an event without being looked through for nothing", () => {
  const items = Array.from({ length: FLEET }, (_, i) => row(`d${i}`));
  const pages = Array.from({ length: FLEET / 500 }, (_, i) => ({
    items: items.slice(i * 500, (i + 1) * 500),
    next_cursor: "more",
  }));
  const key = keys.deviceList(EVERYTHING);
  client.setQueryData(key, { pages, pageParams: pages.map(() => null) });
  for (let i = 0; i < EVENTS; i++) installationInLists(client, told(`d${i}`, "confirmed"), soon);
  const after = client.getQueryData<InfiniteData<Page<Device>>>(key)?.pages ?? [];
  expect(after[0]?.items.slice(0, EVENTS).every(({ stage }) => stage === "confirmed")).toBe(true);
  expect(after[0]?.items.slice(EVENTS)).toEqual(items.slice(EVENTS, 500));
  expect(after.slice(1).every((page, i) => page === pages[i + 1])).toBe(true);
});
