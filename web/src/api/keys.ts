import type { AlertKind, AlertState, CurrentMountStatus, DeviceOrder, Severity, Stage } from "./types";

/** Which devices are listed and in which order, named as the API's parameters; "": whichever. */
export interface DeviceFilter {
  q: string;
  stage: Stage | "";
  alert_severity: Severity | "";
  alert_kind: AlertKind | "";
  mount_status: CurrentMountStatus | "";
  sort: DeviceOrder;
}

export interface TimeRange {
  from: string | null;
  to: string | null;
}

export interface AlertFilter {
  state: AlertState | "unresolved" | "all";
  kind: AlertKind | "";
  severity: Severity | "";
  deviceId: string;
  /** days of the reader's calendar, such as 2025-11-22, both included; "": no limit */
  from: string;
  to: string;
}

export interface AuditFilter {
  actor: string;
  action: string;
  target: string;
}

/** Names of what is cached. Everything of one device stands below `device(id)`. */
export const keys = {
  session: ["session"],
  summary: ["summary"],
  devices: ["devices"],
  deviceList: (filter: DeviceFilter) => ["devices", filter],
  device: (id: string) => ["device", id],
  installation: (id: string) => ["device", id, "installation"],
  estimates: (id: string) => ["device", id, "estimates"],
  /** history that no event of the live stream changes */
  past: (id: string) => ["device", id, "past"],
  /** computed from raw data: nothing that has been computed changes, what comes in is beyond it */
  motion: (id: string) => ["device", id, "motion"],
  motionEvents: (id: string) => ["device", id, "events"],
  mounts: (id: string) => ["device", id, "mounts"],
  alerts: (id: string) => ["device", id, "alerts"],
  alertLists: ["alerts"],
  alertList: (filter: AlertFilter) => ["alerts", filter],
  alert: (id: number) => ["alert", id],
  deviceChoices: (q: string) => ["device-choices", q],
  unread: ["unread"],
  accessKeys: ["access-keys"],
  webhooks: ["webhooks"],
  deliveries: (id: number) => ["deliveries", id],
  thresholds: ["thresholds"],
  audit: (filter: AuditFilter) => ["audit", filter],
  version: ["version"],
} as const;
