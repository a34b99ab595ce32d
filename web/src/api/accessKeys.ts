/** The keys that open the service: list, make, revoke. */
import { useInfiniteQuery, useMutation, useQueryClient } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys } from "./keys";
import type { KeyDraft } from "./types";

export function useAccessKeys() {
  return useInfiniteQuery({
    queryKey: keys.accessKeys,
    queryFn: ({ pageParam }) =>
      answer(http.GET("/api/v1/keys", { params: { query: pageParam ? { cursor: pageParam } : {} } })),
    initialPageParam: null as string | null,
    getNextPageParam: (page) => page.next_cursor,
    select: ({ pages }) => pages.flatMap((page) => page.items),
  });
}

export function useMakeKey() {
  const client = useQueryClient();
  return useMutation({
    mutationFn: (draft: KeyDraft) => answer(http.POST("/api/v1/keys", { body: draft })),
    onSuccess: () => client.invalidateQueries({ queryKey: keys.accessKeys }),
  });
}

export function useRevokeKey() {
  const client = useQueryClient();
  return useMutation({
    mutationFn: (key_id: number) =>
      answer(http.DELETE("/api/v1/keys/{key_id}", { params: { path: { key_id } } })),
    onSettled: () => client.invalidateQueries({ queryKey: keys.accessKeys }),
  });
}
