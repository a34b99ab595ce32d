/** What the service tells of itself: the numbers it decides by, and its version. */
import { useQuery } from "@tanstack/react-query";
import { answer, http, openApi } from "./http";
import { keys } from "./keys";

const FOR_EVER = { staleTime: Number.POSITIVE_INFINITY };

export function useThresholds() {
  return useQuery({
    queryKey: keys.thresholds,
    queryFn: () => answer(http.GET("/api/v1/thresholds")),
    select: ({ items }) => items,
    ...FOR_EVER,
  });
}

/** The version stands in the description of the API, which is read for nothing else. */
export function useVersion() {
  return useQuery({
    queryKey: keys.version,
    queryFn: openApi,
    select: ({ info }) => info.version,
    ...FOR_EVER,
  });
}
