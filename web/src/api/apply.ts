/** Changes the cache as the events of the live stream say. */
import type { QueryClient, QueryKey } from "@tanstack/react-query";
import { applyAlert } from "./applyAlert";
import { deviceInLists, installationInLists } from "./deviceLists";
import { keys } from "./keys";
import { mountChanged, newer, withInstallation } from "./merge";
import type { Alert, Device, DeviceChange, Installation } from "./types";

export type LiveEvent =
  | { type: "installation"; data: Installation }
  | { type: "alert"; data: Alert }
  | { type: "device"; data: DeviceChange };

/** Reads again, soon, what an event tells of but does not contain. */
export type Soon = (key: QueryKey) => void;

/** Apply one event. */
export function apply(client: QueryClient, event: LiveEvent, soon: Soon): void {
  if (event.type === "installation") applyInstallation(client, event.data, soon);
  else if (event.type === "alert") applyAlert(client, event.data, soon);
  else applyDevice(client, event.data, soon);
}

function applyInstallation(client: QueryClient, told: Installation, soon: Soon): void {
  const id = told.device_id;
  const known = client.getQueryData<Installation>(keys.installation(id));
  if (known && mountChanged(known, told)) soon(keys.mounts(id));
  client.setQueryData<Installation>(keys.installation(id), known && newer(known, told));
  client.setQueryData<Device>(keys.device(id), (device) => device && withInstallation(device, told));
  if (known) soon(keys.estimates(id));
  installationInLists(client, told, soon);
  soon(keys.summary);
}

function applyDevice(client: QueryClient, told: DeviceChange, soon: Soon): void {
  if (told.device) client.setQueryData<Device>(keys.device(told.device_id), told.device);
  soon(keys.device(told.device_id));
  deviceInLists(client, told, soon);
  soon(keys.summary);
}
