import { useCallback, useMemo } from "react";
import { useSearchParams } from "wouter";
import { readView, type View, writeView } from "./window";

/** What is looked at stands in the address. */
export function useView(): [View, (view: View) => void] {
  const [params, setParams] = useSearchParams();
  const search = params.toString();
  const view = useMemo(() => readView(search), [search]);
  const change = useCallback((next: View) => setParams(writeView(next)), [setParams]);
  return [view, change];
}
