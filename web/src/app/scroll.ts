import { useLayoutEffect } from "react";
import { useLocation } from "wouter";

/** Coming back, by the browser's own means, and not by a link. wouter tells of those as `pushState`. */
let isBack = true;
addEventListener("popstate", () => {
  isBack = true;
});
addEventListener("pushState", () => {
  isBack = false;
});

/** A page that a link leads to begins at its top; the browser knows where one was on a page that one comes back to. */
export function useScroll(): void {
  const [path] = useLocation();
  // biome-ignore lint/correctness/useExhaustiveDependencies: another path is another page
  useLayoutEffect(() => {
    if (!isBack) scrollTo(0, 0);
  }, [path]);
}
