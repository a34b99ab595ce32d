/** What is asked for before the page that shows it is there. */
import { client } from "../api/client";
import { deviceList } from "../api/devices";
import { installation, summary } from "../api/queries";
import { session } from "../api/session";
import { readFilter } from "../devices/filter";

/** Somebody comes to this address: ask who it is, and at the same time for what most of the page is about. */
export function askEarly({ pathname, search }: Location): void {
  client.prefetchQuery(session);
  const [, place, id] = pathname.split("/");
  if (place !== "devices") return;
  client.prefetchQuery(summary);
  if (id) client.prefetchQuery(installation(decoded(id)));
  else client.prefetchInfiniteQuery(deviceList(readFilter(search)));
}

function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}
