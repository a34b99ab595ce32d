/** The angle history of a device, as TanStack queries. */
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys, type TimeRange } from "./keys";
import type { Estimates } from "./types";

/** ms; estimates that are kept for long are a minute apart */
const BEFORE = 120_000;

export function readEstimates(id: string, range: TimeRange, max_points: number): Promise<Estimates> {
  const query = { max_points, ...(range.from && { from: range.from }), ...(range.to && { to: range.to }) };
  return answer(
    http.GET("/api/v1/devices/{device_id}/estimates", { params: { path: { device_id: id }, query } }),
  );
}

interface Wanted {
  range: TimeRange;
  points: number;
  /** it has ended before the newest data: what comes in changes nothing in it */
  past?: boolean;
}

export function useEstimates(id: string, { range, points, past = false }: Wanted) {
  return useQuery({
    queryKey: [...(past ? keys.past(id) : keys.estimates(id)), range, points],
    queryFn: () => readEstimates(id, range, points),
    placeholderData: keepPreviousData,
  });
}

/** The first estimate and the last one, all times considered. */
export function useEnds(id: string, enabled: boolean) {
  return useQuery({
    queryKey: [...keys.past(id), "ends"],
    queryFn: () => readEstimates(id, { from: null, to: null }, 2),
    enabled,
  });
}

/** The session of an estimate just before a moment, as long as the history of that drive is kept; else null. */
export function useSessionAt(id: string, moment: string) {
  const end = Date.parse(moment);
  const range = { from: new Date(end - BEFORE).toISOString(), to: new Date(end + 1).toISOString() };
  return useQuery({
    queryKey: [...keys.past(id), "session", moment],
    queryFn: async () => (await readEstimates(id, range, 2)).session.at(-1) ?? null,
  });
}
