/** The fleet: its devices as a list that is read page by page, and a new one. */
import {
  infiniteQueryOptions,
  keepPreviousData,
  useInfiniteQuery,
  useMutation,
  useQueryClient,
} from "@tanstack/react-query";
import { answer, http } from "./http";
import { type DeviceFilter, keys } from "./keys";
import type { Device, DeviceDraft, Page } from "./types";

/** Few at first, to be there soon; then many, because whoever scrolls goes far. */
const FIRST_PAGE = 200;
const PAGE = 500;

export function useDevices(filter: DeviceFilter) {
  return useInfiniteQuery({ ...deviceList(filter), placeholderData: keepPreviousData });
}

export function deviceList(filter: DeviceFilter) {
  return infiniteQueryOptions({
    queryKey: keys.deviceList(filter),
    queryFn: ({ pageParam, signal }) =>
      answer(http.GET("/api/v1/devices", { params: { query: listQuery(filter, pageParam) }, signal })),
    initialPageParam: null as string | null,
    getNextPageParam: (page) => page.next_cursor,
  });
}

function listQuery(
  { q, stage, alert_severity, alert_kind, mount_status, sort }: DeviceFilter,
  cursor: string | null,
) {
  return {
    limit: cursor ? PAGE : FIRST_PAGE,
    sort,
    ...(q && { q }),
    ...(stage && { stage }),
    ...(alert_severity && { alert_severity }),
    ...(alert_kind && { alert_kind }),
    ...(mount_status && { mount_status }),
    ...(cursor && { cursor }),
  };
}

/** All rows read so far. One that changed its place between two pages may be in both: the first counts. */
export function rowsOf(pages: readonly Page<Device>[]): Device[] {
  const rows = new Map<string, Device>();
  for (const { items } of pages) {
    for (const device of items) if (!rows.has(device.id)) rows.set(device.id, device);
  }
  return [...rows.values()];
}

export function useRegister() {
  const client = useQueryClient();
  return useMutation({
    mutationFn: (draft: DeviceDraft) => answer(http.POST("/api/v1/devices", { body: draft })),
    onSuccess: () => {
      client.invalidateQueries({ queryKey: keys.devices });
      client.invalidateQueries({ queryKey: keys.summary });
    },
  });
}
