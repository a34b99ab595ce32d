/** What the list is narrowed to and how it is sorted, as it stands in the page's address: "?stage=waiting&sort=-name". */
import type { DeviceFilter } from "../api/keys";
import type { AlertKind, CurrentMountStatus, DeviceOrder, FleetSummary, Severity } from "../api/types";
import { STAGES } from "../lib/stages";

export const EVERYTHING: DeviceFilter = {
  q: "",
  stage: "",
  alert_severity: "",
  alert_kind: "",
  mount_status: "",
  sort: "id",
};

export const SEVERITIES = ["critical", "warning", "info"] as const satisfies readonly Severity[];

/** What else has a tile of its own: one kind of alert, and mountings in doubt. */
export const SILENT = "device_silent" satisfies AlertKind;
export const SUSPECT = "suspect" satisfies CurrentMountStatus;

export const ORDERS = [
  "id",
  "-id",
  "name",
  "-name",
  "last_data_at",
  "-last_data_at",
] as const satisfies readonly DeviceOrder[];

/** What narrows the list; everything but the order. */
export const RESTRICTIONS = ["q", "stage", "alert_severity", "alert_kind", "mount_status"] as const;
export type Restriction = (typeof RESTRICTIONS)[number];

/** Whatever is not understood is left out: an address may have been typed, or be of another version. */
export function readFilter(search: string): DeviceFilter {
  const given = new URLSearchParams(search);
  const oneOf = <T extends string>(all: readonly T[], name: string) =>
    all.find((value) => value === given.get(name));
  return {
    q: given.get("q") ?? "",
    stage: oneOf(STAGES, "stage") ?? "",
    alert_severity: oneOf(SEVERITIES, "alert_severity") ?? "",
    alert_kind: oneOf([SILENT], "alert_kind") ?? "",
    mount_status: oneOf([SUSPECT], "mount_status") ?? "",
    sort: oneOf(ORDERS, "sort") ?? EVERYTHING.sort,
  };
}

/** Only what is not as usual is written. */
export function writeFilter(filter: DeviceFilter): string {
  const names = [...RESTRICTIONS, "sort"] as const;
  const written = names.filter((name) => filter[name] !== EVERYTHING[name]);
  return new URLSearchParams(written.map((name) => [name, filter[name]])).toString();
}

/** What narrows the list now. */
export function restrictions(filter: DeviceFilter): Restriction[] {
  return RESTRICTIONS.filter((name) => filter[name].trim() !== "");
}

/** How many devices there are in the list, as far as the counts over the fleet tell before all of it is read. */
export function expected(filter: DeviceFilter, summary: FleetSummary | undefined): number | undefined {
  const [name, ...others] = restrictions(filter);
  if (!summary || others.length > 0 || name === "q") return undefined;
  if (name === undefined) return summary.devices;
  return countOf({ [name]: filter[name] }, summary);
}

/** What a tile narrows the list to. */
export type Narrowing = Partial<Pick<DeviceFilter, Exclude<Restriction, "q">>>;

export function countOf({ stage, alert_severity, alert_kind }: Narrowing, summary: FleetSummary): number {
  if (stage) return summary.stages[stage] ?? 0;
  if (alert_severity) return summary.severities[alert_severity] ?? 0;
  return alert_kind === SILENT ? summary.silent : summary.suspect;
}

/** The order after a press on the head of a column: what is newest first, everything else from A to Z; then turned round. */
export function pressed(sort: DeviceOrder, column: Column): DeviceOrder {
  const first: DeviceOrder = column === "last_data_at" ? "-last_data_at" : column;
  const second: DeviceOrder = column === "last_data_at" ? column : `-${column}`;
  return sort === first ? second : first;
}

export type Column = "id" | "name" | "last_data_at";

export function direction(sort: DeviceOrder, column: Column): "ascending" | "descending" | "none" {
  if (sort === column) return "ascending";
  return sort === `-${column}` ? "descending" : "none";
}
