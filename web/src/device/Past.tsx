import { useIntersection } from "@mantine/hooks";
import { type ComponentType, lazy, Suspense, useState } from "react";
import { Section } from "../components/Section";
import { Failed, Loading } from "../components/States";
import { t } from "../text";

interface PastProps {
  id: string;
  lastData: string | null;
}

const HistorySection = later<PastProps>("history.title", () => import("./history/HistorySection"));
const HealthSection = later<{ id: string }>("history.health.title", () => import("./health/HealthSection"));

/** What the device has been through. Its program comes after the upper half, its data health when somebody scrolls there. */
export function Past({ id, lastData }: PastProps) {
  return (
    <>
      <Suspense fallback={<Coming title={t("history.title")} lines={14} />}>
        <HistorySection id={id} lastData={lastData} />
      </Suspense>
      <WhenSeen id={id} />
    </>
  );
}

function WhenSeen({ id }: { id: string }) {
  const { ref, entry } = useIntersection({ rootMargin: "300px" });
  const [seen, setSeen] = useState(false);
  if (!seen && entry?.isIntersecting) setSeen(true);
  const coming = <Coming title={t("history.health.title")} lines={10} />;
  return (
    <div ref={ref}>
      {seen ? (
        <Suspense fallback={coming}>
          <HealthSection id={id} />
        </Suspense>
      ) : (
        coming
      )}
    </div>
  );
}

/** The same card without its content, as high about, so that nothing jumps. */
function Coming({ title, lines }: { title: string; lines: number }) {
  return (
    <Section title={title} className="no-print">
      <Loading what={title} lines={lines} />
    </Section>
  );
}

/** A section whose program is fetched when it is wanted; where that fails, it says so. */
function later<P>(
  title: "history.title" | "history.health.title",
  load: () => Promise<{ default: ComponentType<P> }>,
) {
  return lazy(() =>
    load().catch((error: Error) => ({
      default: () => (
        <Section title={t(title)} className="no-print">
          <Failed what={t(title)} error={error} retry={() => location.reload()} />
        </Section>
      ),
    })),
  );
}
