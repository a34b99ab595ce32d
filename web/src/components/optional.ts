import { type ComponentType, type LazyExoticComponent, lazy } from "react";

/** A part that comes when it is needed; where it does not come, on a bad line, the page does without it. */
export function optional<P>(
  load: () => Promise<{ default: ComponentType<P> }>,
): LazyExoticComponent<ComponentType<P>> {
  return lazy(() => load().catch(() => ({ default: () => null })));
}
