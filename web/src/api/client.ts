/** What is known of the service's answers, for the whole page. */
import { QueryCache, QueryClient } from "@tanstack/react-query";
import { Problem } from "./http";
import { keys } from "./keys";

/** A refusal (4xx) is an answer; only silence and the service's own trouble are worth another try. */
function worthRetrying(count: number, error: Error): boolean {
  return count < 3 && !(error instanceof Problem && error.status >= 400 && error.status < 500);
}

export const client: QueryClient = new QueryClient({
  defaultOptions: { queries: { retry: worthRetrying, staleTime: 30_000, refetchOnWindowFocus: false } },
  queryCache: new QueryCache({ onError: signedOut }),
});

/** The session ended while the page was open: back to the sign-in. */
function signedOut(error: Error): void {
  if (error instanceof Problem && error.status === 401) client.setQueryData(keys.session, null);
}
