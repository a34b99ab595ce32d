import { useIntersection } from "@mantine/hooks";
import { lazy, Suspense, useState } from "react";
import { Section } from "../components/Section";
import { Loading } from "../components/States";
import { t } from "../text";

const HistorySection = lazy(() =>
  import("./history/HistorySection").then((m) => ({ default: m.HistorySection })),
);
const HealthSection = lazy(() =>
  import("./health/HealthSection").then((m) => ({ default: m.HealthSection })),
);

/** What the device has been through. Its program comes after the upper half, its data health when somebody scrolls there. */
export function Past({ id, lastData }: { id: string; lastData: string | null }) {
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
