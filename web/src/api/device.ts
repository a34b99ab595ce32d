/** What an installer does with one device: change what is written about it, give it another key, remove it. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys } from "./keys";
import type { DevicePatch } from "./types";

const of = (device_id: string) => ({ params: { path: { device_id } } });

export function useEditDevice(id: string) {
  const client = useQueryClient();
  return useMutation({
    mutationFn: (patch: DevicePatch) =>
      answer(http.PATCH("/api/v1/devices/{device_id}", { ...of(id), body: patch })),
    onSuccess: (device) => {
      client.setQueryData(keys.device(id), device);
      client.invalidateQueries({ queryKey: keys.devices });
    },
  });
}

/** The key is in the answer and nowhere else: it is kept no longer than whoever asked for it shows it. */
export function useNewKey(id: string) {
  return useMutation({
    mutationFn: () => answer(http.POST("/api/v1/devices/{device_id}/key", of(id))),
    gcTime: 0,
  });
}

export function useRemoveDevice(id: string) {
  const client = useQueryClient();
  return useMutation({
    mutationFn: () => answer(http.DELETE("/api/v1/devices/{device_id}", of(id))),
    onSuccess: () => {
      client.invalidateQueries({ queryKey: keys.devices });
      client.invalidateQueries({ queryKey: keys.summary });
    },
  });
}
