/** Alerts that were opened since this browser last looked at the list of alerts, by the service's clock. */
import { useDocumentVisibility, useLocalStorage } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys } from "./keys";
import { useMay } from "./session";
import type { Alert, Page } from "./types";

const STORED = "livella-alerts-seen";
/** ms; the live stream rests while nobody looks at the page, but just then its title is read. */
const HIDDEN_LOOK = 60_000;
/** "99+" is said of more. */
export const MOST = 99;

/** When the newest alert was opened that this browser has shown; null before the first look. */
function useSeen() {
  return useLocalStorage<string | null>({
    key: STORED,
    defaultValue: null,
    getInitialValueInEffect: false,
  });
}

/** The unread alerts, newest first and a few more than are counted; nothing for those who may not read alerts. */
export function useUnread(): { unread: Alert[]; markSeen: () => void } {
  const [seen, setSeen] = useSeen();
  const hidden = useDocumentVisibility() === "hidden";
  const { data } = useQuery({
    queryKey: keys.unread,
    queryFn: () => readSince(seen),
    enabled: useMay("manager"),
    refetchInterval: hidden ? HIDDEN_LOOK : false,
    refetchIntervalInBackground: true,
  });
  const unread = data ? openedAfter(data, seen) : [];
  const newest = unread[0]?.opened_at;
  return { unread, markSeen: () => newest && setSeen(newest) };
}

function readSince(seen: string | null): Promise<Page<Alert>> {
  const query = { state: "open" as const, limit: MOST + 2, ...(seen && { since: seen }) };
  return answer(http.GET("/api/v1/alerts", { params: { query } }));
}

/** The service gives what was opened at or after a moment; what was opened just then has been seen. */
export function openedAfter({ items }: Page<Alert>, seen: string | null): Alert[] {
  if (seen === null) return items;
  return items.filter(({ opened_at }) => Date.parse(opened_at) > Date.parse(seen));
}
