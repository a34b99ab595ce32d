/** Alerts over the whole fleet: lists, one of them, and what a manager does with them. */
import {
  keepPreviousData,
  type QueryKey,
  useInfiniteQuery,
  useMutation,
  useQuery,
  useQueryClient,
} from "@tanstack/react-query";
import { each } from "../lib/each";
import { beginning, following, nextPage, period, shown, statesOf } from "./alertList";
import { applyAlert } from "./applyAlert";
import { answer, http } from "./http";
import { type AlertFilter, keys } from "./keys";
import type { Alert, AlertState } from "./types";

const PAGE = 50;
/** Requests that run at the same time when many alerts are settled. */
const AT_ONCE = 4;

export function useAlerts(filter: AlertFilter) {
  const states = statesOf(filter);
  return useInfiniteQuery({
    queryKey: keys.alertList(filter),
    queryFn: ({ pageParam }) =>
      nextPage(pageParam, (list, cursor) => readPage(filter, states[list] ?? null, cursor)),
    initialPageParam: beginning(states.length),
    getNextPageParam: following,
    placeholderData: keepPreviousData,
    select: ({ pages }) => shown(pages),
  });
}

function readPage(filter: AlertFilter, state: AlertState | null, cursor: string | null) {
  const [since, until] = period(filter);
  const query = {
    limit: PAGE,
    ...(state && { state }),
    ...(filter.kind && { kind: filter.kind }),
    ...(filter.severity && { severity: filter.severity }),
    ...(filter.deviceId && { device_id: filter.deviceId }),
    ...(since && { since: since.toISOString() }),
    ...(until && { until: until.toISOString() }),
    ...(cursor && { cursor }),
  };
  return answer(http.GET("/api/v1/alerts", { params: { query } }));
}

const of = (alert_id: number) => ({ params: { path: { alert_id } } });

export function useAlert(id: number) {
  return useQuery({
    queryKey: keys.alert(id),
    queryFn: () => answer(http.GET("/api/v1/alerts/{alert_id}", of(id))),
  });
}

export type Verb = "acknowledge" | "resolve";

export interface Settling {
  alerts: readonly Alert[];
  verb: Verb;
  note: string;
  /** told after each, with how many are done or have failed */
  onProgress?: (finished: number) => void;
}

/** Acknowledge or resolve alerts; gives what became of each. What hangs on them is read again once, at the end. */
export function useSettle() {
  const client = useQueryClient();
  return useMutation({
    mutationFn: async ({ alerts, verb, note, onProgress }: Settling) => {
      const touched = new Map<string, QueryKey>();
      let finished = 0;
      const outcomes = await each(alerts, AT_ONCE, async (alert) => {
        try {
          const after = await settle(alert.id, verb, note);
          applyAlert(client, after, (key) => touched.set(JSON.stringify(key), key));
          return after;
        } finally {
          onProgress?.(++finished);
        }
      });
      for (const queryKey of touched.values()) client.invalidateQueries({ queryKey });
      return outcomes;
    },
  });
}

function settle(id: number, verb: Verb, note: string): Promise<Alert> {
  const path = `/api/v1/alerts/{alert_id}/${verb}` as const;
  return answer(http.POST(path, { ...of(id), body: { note: note || null } }));
}
