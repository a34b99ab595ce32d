/** Changes the cache as the events of the live stream say. */
import type { InfiniteData, QueryClient, QueryKey } from "@tanstack/react-query";
import { type DeviceFilter, keys } from "./keys";
import { mountChanged, newer, replaced, withAlert, withInstallation } from "./merge";
import type { Alert, Device, DeviceChange, Installation, Page } from "./types";

export type LiveEvent =
  | { type: "installation"; data: Installation }
  | { type: "alert"; data: Alert }
  | { type: "device"; data: DeviceChange };

type DeviceList = InfiniteData<Page<Device>>;

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
  client.setQueriesData<DeviceList>({ queryKey: keys.devices }, (list) =>
    mapPages(list, (page) => mapItem(page, id, (device) => withInstallation(device, told))),
  );
  for (const key of listsWithOtherMembers(client, told)) soon(key);
  soon(keys.estimates(id));
  soon(keys.summary);
}

/** Lists of one stage that the device has just entered or left. */
function listsWithOtherMembers(client: QueryClient, { device_id, stage }: Installation): QueryKey[] {
  return client.getQueriesData<DeviceList>({ queryKey: keys.devices }).flatMap(([key, list]) => {
    const wanted = (key[1] as DeviceFilter).stage;
    const listed = list?.pages.some((page) => page.items.some(({ id }) => id === device_id));
    return wanted && listed !== (wanted === stage) ? [key] : [];
  });
}

function applyAlert(client: QueryClient, told: Alert, soon: Soon): void {
  const key = keys.alerts(told.device_id);
  client.setQueryData<Page<Alert>>(key, (page) => page && withAlert(page, told));
  soon(keys.installation(told.device_id));
  soon(keys.devices);
  soon(keys.summary);
}

function applyDevice(client: QueryClient, { device_id, device }: DeviceChange, soon: Soon): void {
  if (device) {
    client.setQueryData<Device>(keys.device(device_id), device);
    client.setQueriesData<DeviceList>({ queryKey: keys.devices }, (list) =>
      mapPages(list, (page) => replaced(page, device)),
    );
  }
  soon(keys.device(device_id));
  soon(keys.devices);
  soon(keys.summary);
}

function mapPages(
  list: DeviceList | undefined,
  change: (page: Page<Device>) => Page<Device>,
): DeviceList | undefined {
  if (!list) return list;
  const pages = list.pages.map(change);
  return pages.every((page, i) => page === list.pages[i]) ? list : { ...list, pages };
}

function mapItem(page: Page<Device>, id: string, change: (device: Device) => Device): Page<Device> {
  const device = page.items.find((item) => item.id === id);
  const changed = device && change(device);
  return changed && changed !== device ? replaced(page, changed) : page;
}
