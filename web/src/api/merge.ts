/** How an event of the live stream changes what is already known. Pure: old in, new out, the same object when nothing changes. */
import type { Alert, Device, Installation, Page } from "./types";

/** An event may overtake an answer: the higher revision wins, and of two equal ones the later told (its count of alerts may differ). */
export function newer(known: Installation | undefined, told: Installation): Installation {
  return known && known.revision > told.revision ? known : told;
}

/** What a device's row in the list takes from its installation. */
export function withInstallation(device: Device, told: Installation): Device {
  if (device.id !== told.device_id || device.revision > told.revision) return device;
  return {
    ...device,
    stage: told.stage,
    progress: told.progress,
    mount_status: told.mount?.status ?? null,
    open_alerts: told.open_alerts,
    last_data_at: told.last_data_at,
    revision: told.revision,
  };
}

/** Replace the item of the same id, keeping every other object as it is. */
export function replaced<T extends { id: string | number }>(page: Page<T>, item: T): Page<T> {
  if (!page.items.some(({ id }) => id === item.id)) return page;
  return { ...page, items: page.items.map((old) => (old.id === item.id ? item : old)) };
}

/** Newest first; a known alert stays where it is. */
export function withAlert(page: Page<Alert>, told: Alert): Page<Alert> {
  const known = page.items.find(({ id }) => id === told.id);
  if (!known) return { ...page, items: [told, ...page.items] };
  return later(known, told) === known ? page : replaced(page, told);
}

/** An event may overtake an answer: of two states of an alert, the later one. */
export function later(known: Alert, told: Alert): Alert {
  return Date.parse(known.updated_at) > Date.parse(told.updated_at) ? known : told;
}

/**
 * Does this event say that there is another confirmed mounting, or something else of the one there is? Its time is one such
 * thing: the service learns the zero of a device's clock better with every chunk.
 */
export function mountChanged(known: Installation, told: Installation): boolean {
  const [before, now] = [known.mount, told.mount];
  return (
    before?.id !== now?.id || before?.status !== now?.status || before?.confirmed_at !== now?.confirmed_at
  );
}
