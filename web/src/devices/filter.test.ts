import { describe, expect, it } from "vitest";
import type { DeviceFilter } from "../api/keys";
import type { FleetSummary } from "../api/types";
import { direction, EVERYTHING, expected, pressed, readFilter, restrictions, writeFilter } from "./filter";

const filter = (over: Partial<DeviceFilter>): DeviceFilter => ({ ...EVERYTHING, ...over });

describe("the address", () => {
  it.each<[string, Partial<DeviceFilter>]>([
    ["", {}],
    ["q=van+12", { q: "van 12" }],
    ["q=M%C3%BCnchen+%26+S%C3%B6hne%3D", { q: "München & Söhne=" }],
    ["stage=waiting", { stage: "waiting" }],
    ["alert_severity=critical", { alert_severity: "critical" }],
    ["alert_kind=device_silent", { alert_kind: "device_silent" }],
    ["mount_status=suspect", { mount_status: "suspect" }],
    ["sort=-last_data_at", { sort: "-last_data_at" }],
    [
      "q=a&stage=confirmed&alert_kind=device_silent&sort=name",
      {
        q: "a",
        stage: "confirmed",
        alert_kind: "device_silent",
        sort: "name",
      },
    ],
  ])("%s says and is said", (search, over) => {
    expect(readFilter(search)).toEqual(filter(over));
    expect(writeFilter(filter(over))).toBe(search);
  });

  it.each([
    "stage=sleeping",
    "sort=colour",
    "alert_kind=constructor",
    "mount_status=superseded",
    "stage=&sort=",
    "page=3",
  ])("that nobody wrote is left out: %s", (search) => expect(readFilter(search)).toEqual(EVERYTHING));

  it("keeps what is being typed as it is, blanks at its end too", () => {
    expect(readFilter(writeFilter(filter({ q: "van " }))).q).toBe("van ");
  });
});

it("blanks narrow nothing, and the order does not either", () => {
  expect(restrictions(filter({ q: "  ", sort: "-name" }))).toEqual([]);
  expect(restrictions(filter({ q: "a", stage: "waiting" }))).toEqual(["q", "stage"]);
});

describe("how many are expected", () => {
  const summary: FleetSummary = {
    devices: 10,
    stages: { waiting: 4, confirmed: 6 } as FleetSummary["stages"],
    open_alerts: 3,
    alerts: {},
    severities: { critical: 1, warning: 2 },
    silent: 2,
    suspect: 5,
  };

  it.each<[Partial<DeviceFilter>, number | undefined]>([
    [{}, 10],
    [{ stage: "waiting", sort: "-name" }, 4],
    [{ stage: "aligning" }, 0],
    [{ alert_severity: "warning" }, 2],
    [{ alert_severity: "info" }, 0],
    [{ alert_kind: "device_silent" }, 2],
    [{ mount_status: "suspect" }, 5],
    [{ q: "van" }, undefined],
    [{ stage: "waiting", alert_severity: "warning" }, undefined],
  ])("%o: %s", (over, count) => expect(expected(filter(over), summary)).toBe(count));

  it("is not known before the counts are there", () =>
    expect(expected(EVERYTHING, undefined)).toBeUndefined());
});

it.each([
  ["id", "name", "name"],
  ["name", "name", "-name"],
  ["-name", "name", "name"],
  ["name", "last_data_at", "-last_data_at"],
  ["-last_data_at", "last_data_at", "last_data_at"],
] as const)("sorted by %s, a press on %s gives %s", (sort, column, after) => {
  expect(pressed(sort, column)).toBe(after);
  expect(direction(after, column)).toBe(after.startsWith("-") ? "descending" : "ascending");
});
