/** The motion of a device's vehicle and what happened to it, as TanStack queries. */
import { keepPreviousData, useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys, type TimeRange } from "./keys";

/** Rows of a stretch: enough for a wide screen. */
const ROWS = 2000;
const EVENTS = 50;

export function useMotion(id: string, range: TimeRange | null, rows = ROWS) {
  return useQuery({
    queryKey: [...keys.motion(id), range, rows],
    queryFn: () =>
      answer(
        http.GET("/api/v1/devices/{device_id}/motion", {
          params: {
            path: { device_id: id },
            query: {
              max_points: rows,
              ...(range?.from && { from: range.from }),
              ...(range?.to && { to: range.to }),
            },
          },
        }),
      ),
    enabled: range !== null,
    placeholderData: keepPreviousData,
  });
}

export function useMotionEvents(id: string) {
  return useInfiniteQuery({
    queryKey: keys.motionEvents(id),
    queryFn: ({ pageParam }) =>
      answer(
        http.GET("/api/v1/devices/{device_id}/events", {
          params: {
            path: { device_id: id },
            query: { limit: EVENTS, ...(pageParam && { cursor: pageParam }) },
          },
        }),
      ),
    initialPageParam: null as string | null,
    getNextPageParam: ({ next_cursor }) => next_cursor,
  });
}

export function useMotionEvent(id: string, event: number) {
  return useQuery({
    queryKey: [...keys.motionEvents(id), event],
    queryFn: () =>
      answer(
        http.GET("/api/v1/devices/{device_id}/events/{event_id}", {
          params: { path: { device_id: id, event_id: event } },
        }),
      ),
  });
}
