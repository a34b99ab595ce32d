/** The audit trail. */
import { keepPreviousData, useInfiniteQuery } from "@tanstack/react-query";
import { answer, http } from "./http";
import { type AuditFilter, keys } from "./keys";

export function useAudit(filter: AuditFilter) {
  return useInfiniteQuery({
    queryKey: keys.audit(filter),
    queryFn: ({ pageParam }) => readPage(filter, pageParam),
    initialPageParam: null as string | null,
    getNextPageParam: (page) => page.next_cursor,
    select: ({ pages }) => pages.flatMap((page) => page.items),
    placeholderData: keepPreviousData,
  });
}

function readPage({ actor, action, target }: AuditFilter, cursor: string | null) {
  const query = {
    limit: 50,
    ...(actor && { actor }),
    ...(action && { action }),
    ...(target && { target }),
    ...(cursor && { cursor }),
  };
  return answer(http.GET("/api/v1/audit", { params: { query } }));
}
