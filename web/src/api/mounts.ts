/** The confirmed mountings of a device, newest first, page by page. */
import { useInfiniteQuery } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys } from "./keys";

const PAGE = 100;

export function useMounts(id: string) {
  return useInfiniteQuery({
    queryKey: keys.mounts(id),
    queryFn: ({ pageParam }) =>
      answer(
        http.GET("/api/v1/devices/{device_id}/mounts", {
          params: {
            path: { device_id: id },
            query: { limit: PAGE, ...(pageParam && { cursor: pageParam }) },
          },
        }),
      ),
    initialPageParam: null as string | null,
    getNextPageParam: (page) => page.next_cursor,
  });
}
