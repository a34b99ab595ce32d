import { useIntersection } from "@mantine/hooks";
import { type ReactNode, Suspense, useState } from "react";

interface WhenSeenProps {
  /** what stands there until then, as high about, so that nothing jumps */
  before: ReactNode;
  children: ReactNode;
}

/** What is far down the page comes, with its program and its data, when somebody scrolls there. */
export function WhenSeen({ before, children }: WhenSeenProps) {
  const { ref, entry } = useIntersection({ rootMargin: "300px" });
  const [seen, setSeen] = useState(false);
  if (!seen && entry?.isIntersecting) setSeen(true);
  return <div ref={ref}>{seen ? <Suspense fallback={before}>{children}</Suspense> : before}</div>;
}
