/** Webhooks and what was sent to them. */
import { useInfiniteQuery, useMutation, useQueryClient } from "@tanstack/react-query";
import { answer, http } from "./http";
import { keys } from "./keys";
import type { Page, Webhook, WebhookDelivery, WebhookDraft } from "./types";

/** ms between two looks; the stream does not tell of webhooks and their deliveries */
const LOOK_AGAIN = 4000;

const of = (webhook_id: number) => ({ params: { path: { webhook_id } } });

export function useWebhooks() {
  return useInfiniteQuery({
    queryKey: keys.webhooks,
    queryFn: ({ pageParam }) =>
      answer(http.GET("/api/v1/webhooks", { params: { query: pageParam ? { cursor: pageParam } : {} } })),
    initialPageParam: null as string | null,
    getNextPageParam: (page) => page.next_cursor,
    select: ({ pages }) => pages.flatMap((page) => page.items),
    refetchInterval: LOOK_AGAIN,
  });
}

export function useDeliveries(id: number) {
  return useInfiniteQuery({
    queryKey: keys.deliveries(id),
    queryFn: ({ pageParam }) => readDeliveries(id, pageParam),
    initialPageParam: null as string | null,
    getNextPageParam: (page) => page.next_cursor,
    select: ({ pages }) => pages.flatMap((page) => page.items),
    refetchInterval: LOOK_AGAIN,
  });
}

function readDeliveries(webhook_id: number, cursor: string | null): Promise<Page<WebhookDelivery>> {
  const params = { path: { webhook_id }, query: { limit: 20, ...(cursor && { cursor }) } };
  return answer(http.GET("/api/v1/webhooks/{webhook_id}/deliveries", { params }));
}

export interface SavedWebhook {
  webhook: Webhook;
  /** null: it has the one it had before */
  secret: string | null;
}

/** Make a webhook, or change the one of this number. */
export function useSaveWebhook(id: number | null) {
  return useChange((draft: WebhookDraft): Promise<SavedWebhook> => {
    if (id === null) return answer(http.POST("/api/v1/webhooks", { body: draft }));
    return changed(id, draft);
  });
}

async function changed(id: number, body: WebhookDraft): Promise<SavedWebhook> {
  const webhook = await answer(http.PATCH("/api/v1/webhooks/{webhook_id}", { ...of(id), body }));
  return { webhook, secret: null };
}

export function useRotateSecret(id: number) {
  return useChange(() => answer(http.POST("/api/v1/webhooks/{webhook_id}/secret", of(id))));
}

export function useRemoveWebhook(id: number) {
  return useChange(() => answer(http.DELETE("/api/v1/webhooks/{webhook_id}", of(id))));
}

export function useTestWebhook(id: number) {
  return useChange(
    () => answer(http.POST("/api/v1/webhooks/{webhook_id}/test", of(id))),
    keys.deliveries(id),
  );
}

export function useRedeliver(id: number) {
  return useChange(
    () => answer(http.POST("/api/v1/webhooks/{webhook_id}/redeliver", of(id))),
    keys.deliveries(id),
  );
}

/** Whatever is done to a webhook, or fails because it is gone, the list is read again. */
function useChange<T, V = void>(change: (variables: V) => Promise<T>, besides?: readonly unknown[]) {
  const client = useQueryClient();
  return useMutation({
    mutationFn: change,
    onSettled: () => {
      client.invalidateQueries({ queryKey: keys.webhooks });
      if (besides) client.invalidateQueries({ queryKey: besides });
    },
  });
}
