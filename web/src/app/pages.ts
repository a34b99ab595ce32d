/** Each page comes, with its texts, when it is first opened, so that the first one is there soon. */
import { type ComponentType, lazy } from "react";
import { openRooms, type Room } from "../text";

const parts = {
  devices: () => import("../devices/DevicesPage").then((m) => m.DevicesPage),
  device: () => import("../device/DevicePage").then((m) => m.DevicePage),
  motion: () => import("../motion/MotionPage").then((m) => m.MotionPage),
  event: () => import("../motion/EventPage").then((m) => m.EventPage),
  alerts: () => import("../alerts/AlertsPage").then((m) => m.AlertsPage),
  settings: () => import("../settings/SettingsPage").then((m) => m.SettingsPage),
};
type Part = keyof typeof parts;

const rooms: Record<Part, Room[]> = {
  devices: ["devices"],
  device: ["device", "history", "mounting", "alerts"],
  motion: ["motion", "device", "history"],
  event: ["motion", "device", "history"],
  alerts: ["alerts", "history", "mounting"],
  settings: ["settings", "alerts"],
};

function page<P>(part: Part, load: () => Promise<ComponentType<P>>) {
  return lazy(async () => {
    const [component] = await Promise.all([load(), openRooms(...rooms[part])]);
    return { default: component };
  });
}

export const DevicesPage = page("devices", parts.devices);
export const DevicePage = page("device", parts.device);
export const MotionPage = page("motion", parts.motion);
export const EventPage = page("event", parts.event);
export const AlertsPage = page("alerts", parts.alerts);
export const SettingsPage = page("settings", parts.settings);

/** Somebody comes to this address: what it shows begins to come while it is still found out who they are. */
export function comesTo(path: string): void {
  const [, place, more, room, event] = path.split("/");
  const ofDevice = room === "motion" ? (event ? "event" : "motion") : "device";
  const part = place === "devices" && more ? ofDevice : place;
  if (part === undefined || !Object.hasOwn(parts, part)) return;
  const wanted = part as Part;
  // a failure is told where the page is shown
  Promise.all([parts[wanted](), openRooms(...rooms[wanted])]).catch(() => undefined);
}
