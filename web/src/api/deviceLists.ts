/** Keeps the cached lists of devices true: what an event tells of a device changes its row, or has the list read again. */
import type { InfiniteData, QueryClient, QueryKey } from "@tanstack/react-query";
import { type DeviceFilter, keys } from "./keys";
import { withInstallation } from "./merge";
import type { Alert, Device, DeviceChange, Installation, Page } from "./types";

type DeviceList = InfiniteData<Page<Device>>;
type Soon = (key: QueryKey) => void;

interface CachedList {
  key: QueryKey;
  filter: DeviceFilter;
  list: DeviceList;
  place: Place | undefined;
}

interface Place {
  page: number;
  row: number;
  device: Device;
}

export function installationInLists(client: QueryClient, told: Installation, soon: Soon): void {
  for (const cached of listsWith(client, told.device_id)) {
    if (moves(cached, told)) soon(cached.key);
    change(client, cached, (device) => withInstallation(device, told));
  }
}

/** Rows count their alerts by what their installations tell; an alert decides who is in a list of alerts. */
export function alertInLists(client: QueryClient, told: Alert, soon: Soon): void {
  for (const { key, filter, place } of listsWith(client, told.device_id)) {
    if (!filter.alert_kind && !filter.alert_severity) continue;
    if (filter.alert_kind && filter.alert_kind !== told.kind) continue;
    const isSevere = !filter.alert_severity || filter.alert_severity === told.severity;
    if ((place !== undefined) !== (isSevere && told.state !== "resolved")) soon(key);
  }
}

/** Only the service knows where a new device, or a new name, belongs. */
export function deviceInLists(client: QueryClient, { device_id, device }: DeviceChange, soon: Soon): void {
  if (device) {
    for (const cached of listsWith(client, device_id)) change(client, cached, () => device);
  }
  soon(keys.devices);
}

/** Does the device now come into the list, leave it, or take another place in it? */
function moves({ filter, list, place }: CachedList, told: Installation): boolean {
  const belongs =
    (filter.stage === "" || filter.stage === told.stage) &&
    (filter.mount_status === "" || filter.mount_status === told.mount?.status);
  if (!place) return belongs && comesIn(list, filter, told.device_id);
  const bySilence = filter.sort === "last_data_at" || filter.sort === "-last_data_at";
  return !belongs || (bySilence && place.device.last_data_at !== told.last_data_at);
}

/** A device that is not in the list may have come into it, or stand further down than was read. */
function comesIn({ pages }: DeviceList, { stage, mount_status, sort }: DeviceFilter, id: string): boolean {
  const isOfSome = stage !== "" || mount_status !== "";
  const end = pages.at(-1);
  const last = end?.items.at(-1);
  if (!last || end?.next_cursor === null) return isOfSome; // all of it was read
  if (sort === "-last_data_at") return true; // it has just sent: on top
  if (!isOfSome || sort === "last_data_at") return false;
  if (sort === "id") return id < last.id;
  return sort === "-id" ? id > last.id : true;
}

function* listsWith(client: QueryClient, id: string): Generator<CachedList> {
  for (const [key, list] of client.getQueriesData<DeviceList>({ queryKey: keys.devices })) {
    if (list) yield { key, filter: key[1] as DeviceFilter, list, place: placeOf(list, id) };
  }
}

function placeOf({ pages }: DeviceList, id: string): Place | undefined {
  for (const [page, { items }] of pages.entries()) {
    const row = items.findIndex((item) => item.id === id);
    const device = items[row];
    if (device) return { page, row, device };
  }
  return undefined;
}

/** Every other row and page stays the same object, so that nothing else is drawn anew. */
function change(client: QueryClient, { key, list, place }: CachedList, to: (device: Device) => Device): void {
  const page = place && list.pages[place.page];
  if (!page) return;
  const changed = to(place.device);
  if (changed === place.device) return;
  const items = replacedAt(page.items, place.row, changed);
  client.setQueryData<DeviceList>(key, {
    ...list,
    pages: replacedAt(list.pages, place.page, { ...page, items }),
  });
}

function replacedAt<T>(all: readonly T[], at: number, item: T): T[] {
  const copy = [...all];
  copy[at] = item;
  return copy;
}
