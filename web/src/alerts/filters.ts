/** The filters of the alerts and how they stand in the address of the page. */
import type { AlertFilter } from "../api/keys";
import type { Alert } from "../api/types";

export const STATES = ["unresolved", "open", "acknowledged", "resolved", "all"] as const;
export const SEVERITIES = ["critical", "warning", "info"] as const satisfies readonly Alert["severity"][];
export const KINDS = [
  "orientation_changed",
  "device_loose",
  "sensor_fault",
  "calibration_stalled",
  "verification_failing",
  "gps_lost",
  "device_silent",
  "clock_fault",
  "impact",
  "harsh_driving",
] as const satisfies readonly Alert["kind"][];

export const UNFILTERED: AlertFilter = {
  state: "unresolved",
  kind: "",
  severity: "",
  deviceId: "",
  from: "",
  to: "",
};

const DAY = /^\d{4}-\d\d-\d\d$/;

/** What an address asks for; what it says that is not a filter is left out. */
export function fromAddress(address: URLSearchParams): AlertFilter {
  const said = (name: string) => address.get(name) ?? "";
  return {
    state: STATES.find((state) => state === said("state")) ?? UNFILTERED.state,
    kind: KINDS.find((kind) => kind === said("kind")) ?? "",
    severity: SEVERITIES.find((severity) => severity === said("severity")) ?? "",
    deviceId: said("device"),
    from: day(said("since")),
    to: day(said("until")),
  };
}

function day(text: string): string {
  return DAY.test(text) && !Number.isNaN(Date.parse(text)) ? text : "";
}

/** The shortest address of a filter: what is as usual is not in it. */
export function toAddress({ state, kind, severity, deviceId, from, to }: AlertFilter): URLSearchParams {
  const said = {
    state: state === UNFILTERED.state ? "" : state,
    kind,
    severity,
    device: deviceId.trim(),
    since: from,
    until: to,
  };
  return new URLSearchParams(Object.entries(said).filter(([, value]) => value !== ""));
}

/** How many of the filters besides the state are set. */
export function filtersSet({ kind, severity, deviceId, from, to }: AlertFilter): number {
  return [kind, severity, deviceId, from, to].filter((value) => value !== "").length;
}
