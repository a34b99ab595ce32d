/** What became of a device's data. */
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys } from "./keys";

/** ms; no event of the live stream tells of it */
const OFTEN = 60_000;

export function useHealth(id: string, hours: number) {
  return useQuery({
    queryKey: [...keys.device(id), "health", hours],
    queryFn: () =>
      answer(
        http.GET("/api/v1/devices/{device_id}/health", {
          params: { path: { device_id: id }, query: { hours } },
        }),
      ),
    placeholderData: keepPreviousData,
    refetchInterval: OFTEN,
  });
}
