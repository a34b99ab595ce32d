/**
 * The alerts of a filter, newest first. The service lists one state at a time or all of them; several states are several
 * lists, which are read page by page and put together here. Pure, but for the reading.
 */
import type { AlertFilter } from "./keys";
import type { Alert, AlertState, Page } from "./types";

/** How far one of the lists has been read. */
export interface Place {
  cursor: string | null;
  ended: boolean;
  /** read, but not yet shown: older than where another list has to be read on */
  waiting: Alert[];
}

export interface AlertPage {
  items: Alert[];
  places: Place[];
}

type ReadPage = (list: number, cursor: string | null) => Promise<Page<Alert>>;

/** The states a filter asks for, one list each; null: whatever the state. */
export function statesOf({ state }: AlertFilter): (AlertState | null)[] {
  if (state === "unresolved") return ["open", "acknowledged"];
  return [state === "all" ? null : state];
}

export function beginning(lists: number): Place[] {
  return Array.from({ length: lists }, () => ({ cursor: null, ended: false, waiting: [] }));
}

/** Read on in each list of which nothing waits, and give what is certain to come next. */
export async function nextPage(places: readonly Place[], read: ReadPage): Promise<AlertPage> {
  return certain(await Promise.all(places.map((place, list) => filled(place, list, read))));
}

async function filled(place: Place, list: number, read: ReadPage): Promise<Place> {
  if (place.ended || place.waiting.length > 0) return place;
  const { items, next_cursor } = await read(list, place.cursor);
  return { cursor: next_cursor, ended: next_cursor === null, waiting: items };
}

/** Certain is what is not older than the last thing known of any list that goes on. */
function certain(places: readonly Place[]): AlertPage {
  const ends = places.filter(({ ended }) => !ended).flatMap(({ waiting }) => waiting.slice(-1));
  const isCertain = (alert: Alert) => ends.every((end) => byAge(alert, end) <= 0);
  return {
    items: places.flatMap(({ waiting }) => waiting.filter(isCertain)).sort(byAge),
    places: places.map((place) => ({
      ...place,
      waiting: place.waiting.filter((alert) => !isCertain(alert)),
    })),
  };
}

/** Negative when the first was opened later, as the service sorts them. */
function byAge(a: Alert, b: Alert): number {
  return Date.parse(b.opened_at) - Date.parse(a.opened_at) || b.id - a.id;
}

/** Where the next page begins; null when this was the last one. */
export function following({ places }: AlertPage): Place[] | null {
  return places.every(({ ended, waiting }) => ended && waiting.length === 0) ? null : places;
}

/** All that was read. One that has just gone from one list to another may be in both. */
export function shown(pages: readonly AlertPage[]): Alert[] {
  const items = pages.flatMap((page) => page.items);
  return [...new Map(items.map((alert) => [alert.id, alert])).values()];
}

/** Change an alert wherever the page has it; the same object when it is not there. */
export function withChanged(page: AlertPage, id: number, change: (alert: Alert) => Alert): AlertPage {
  const all = [page.items, ...page.places.map(({ waiting }) => waiting)];
  if (!all.some((alerts) => alerts.some((alert) => alert.id === id))) return page;
  const mapped = (alerts: Alert[]) => alerts.map((alert) => (alert.id === id ? change(alert) : alert));
  return {
    items: mapped(page.items),
    places: page.places.map((place) => ({ ...place, waiting: mapped(place.waiting) })),
  };
}

/** Does the filter let this alert through? */
export function matches(filter: AlertFilter, alert: Alert): boolean {
  const [since, until] = period(filter);
  const opened = Date.parse(alert.opened_at);
  return (
    statesOf(filter).some((state) => state === null || state === alert.state) &&
    (filter.kind === "" || filter.kind === alert.kind) &&
    (filter.severity === "" || filter.severity === alert.severity) &&
    (filter.deviceId === "" || filter.deviceId === alert.device_id) &&
    (since === null || opened >= since.getTime()) &&
    (until === null || opened < until.getTime())
  );
}

/** The period of a filter: from the beginning of its first day to before that of the day after the last, on the reader's clock. */
export function period({ from, to }: AlertFilter): [Date | null, Date | null] {
  return [midnight(from, 0), midnight(to, 1)];
}

function midnight(day: string, later: number): Date | null {
  const [year, month, date] = day.split("-").map(Number);
  if (year === undefined || month === undefined || date === undefined) return null;
  return new Date(year, month - 1, date + later);
}
