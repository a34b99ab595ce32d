/** What the page reads and does, as TanStack queries. Live updates come in through `live.ts`. */
import { queryOptions, replaceEqualDeep, useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys } from "./keys";
import { newer } from "./merge";
import type { Installation } from "./types";

const PAGE = 100;

export const summary = queryOptions({
  queryKey: keys.summary,
  queryFn: () => answer(http.GET("/api/v1/fleet/summary")),
});

export function useSummary() {
  return useQuery(summary);
}

const of = (device_id: string) => ({ params: { path: { device_id } } });

export function useDevice(id: string, enabled: boolean) {
  return useQuery({
    queryKey: keys.device(id),
    queryFn: () => answer(http.GET("/api/v1/devices/{device_id}", of(id))),
    enabled,
  });
}

export function useInstallation(id: string) {
  return useQuery(installation(id));
}

export function installation(id: string) {
  return queryOptions({
    queryKey: keys.installation(id),
    queryFn: () => answer(http.GET("/api/v1/devices/{device_id}/installation", of(id))),
    structuralSharing: (known, told) =>
      replaceEqualDeep(known, newer(known as Installation | undefined, told as Installation)),
  });
}

export function useDeviceAlerts(id: string, enabled: boolean) {
  return useQuery({
    queryKey: keys.alerts(id),
    queryFn: () => answer(http.GET("/api/v1/alerts", { params: { query: { device_id: id, limit: PAGE } } })),
    enabled,
  });
}

export function useRestart(id: string) {
  return useInstallationChange(id, () =>
    answer(http.POST("/api/v1/devices/{device_id}/installation/restart", of(id))),
  );
}

export function useLevelStart(id: string) {
  return useInstallationChange(id, () =>
    answer(http.POST("/api/v1/devices/{device_id}/installation/level", of(id))),
  );
}

/** Something an installer does to the installation; the service answers with what it then is. */
function useInstallationChange(id: string, change: () => Promise<Installation>) {
  const client = useQueryClient();
  return useMutation({
    mutationFn: change,
    onSuccess: (installation) => {
      client.setQueryData(keys.installation(id), installation);
      client.invalidateQueries({ queryKey: keys.device(id) });
    },
  });
}
