/** Brings an alert as it is now, told by the live stream or by an answer, into the cache. */
import type { InfiniteData, QueryClient, QueryKey } from "@tanstack/react-query";
import { type AlertPage, matches, shown, withChanged } from "./alertList";
import { alertInLists } from "./deviceLists";
import { type AlertFilter, keys } from "./keys";
import { later, withAlert } from "./merge";
import type { Alert, Page } from "./types";

type AlertList = InfiniteData<AlertPage>;

export function applyAlert(client: QueryClient, told: Alert, soon: (key: QueryKey) => void): void {
  const ofDevice = keys.alerts(told.device_id);
  client.setQueryData<Page<Alert>>(ofDevice, (page) => page && withAlert(page, told));
  client.setQueryData<Alert>(keys.alert(told.id), (known) => known && later(known, told));
  for (const [key, list] of client.getQueriesData<AlertList>({ queryKey: keys.alertLists })) {
    if (list) applyToList(client, key, list, told, soon);
  }
  soon(keys.installation(told.device_id));
  alertInLists(client, told, soon);
  soon(keys.summary);
  soon(keys.unread);
}

/** One that now belongs into the list, or no longer does, stays where it is until the list is read again. */
function applyToList(
  client: QueryClient,
  key: QueryKey,
  list: AlertList,
  told: Alert,
  soon: (key: QueryKey) => void,
): void {
  const pages = list.pages.map((page) => withChanged(page, told.id, (known) => later(known, told)));
  if (pages.some((page, i) => page !== list.pages[i])) client.setQueryData(key, { ...list, pages });
  const isListed = shown(list.pages).some(({ id }) => id === told.id);
  if (isListed !== matches(key[1] as AlertFilter, told)) soon(key);
}
