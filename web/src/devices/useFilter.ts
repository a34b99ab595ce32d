import { useCallback, useMemo } from "react";
import { useSearchParams } from "wouter";
import type { DeviceFilter } from "../api/keys";
import { readFilter, writeFilter } from "./filter";

export type Change = (change: Partial<DeviceFilter>, options?: { replace: boolean }) => void;

/** What the list shows stands in the address: it can be shared, reloaded, and gone back to. */
export function useFilter(): [DeviceFilter, Change] {
  const [params, setParams] = useSearchParams();
  const search = params.toString();
  const filter = useMemo(() => readFilter(search), [search]);
  const change = useCallback<Change>(
    (changed, options) =>
      setParams((now) => writeFilter({ ...readFilter(now.toString()), ...changed }), options),
    [setParams],
  );
  return [filter, change];
}
