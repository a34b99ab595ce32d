import { type ComponentType, type LazyExoticComponent, lazy } from "react";
import { Problem } from "../api/http";
import { Failed } from "./States";

/** A part that comes when it is looked at and that the page cannot do without: where it does not come, that is told. */
export function needed<P>(
  what: () => string,
  load: () => Promise<{ default: ComponentType<P> }>,
): LazyExoticComponent<ComponentType<P>> {
  const missing = (error: Error) => () => (
    <Failed what={what()} error={new Problem(0, error.message)} retry={() => location.reload()} />
  );
  return lazy(() => load().catch((error: Error) => ({ default: missing(error) })));
}
