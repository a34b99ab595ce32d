/** Devices to choose from while somebody types. */
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys } from "./keys";
import type { Device } from "./types";

const MOST = 12;

export function useDeviceChoices(q: string): Device[] {
  const { data } = useQuery({
    queryKey: keys.deviceChoices(q),
    queryFn: () => answer(http.GET("/api/v1/devices", { params: { query: { q, limit: MOST } } })),
    enabled: q !== "",
    placeholderData: keepPreviousData,
  });
  return data?.items ?? [];
}
