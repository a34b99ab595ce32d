import { type ComponentType, lazy } from "react";
import { Section } from "../components/Section";
import { Failed, Loading } from "../components/States";
import { WhenSeen } from "../components/WhenSeen";
import { t } from "../text";

interface PastProps {
  id: string;
  lastData: string | null;
}

const HistorySection = later<PastProps>("history.title", () => import("./history/HistorySection"));
const HealthSection = later<{ id: string }>("history.health.title", () => import("./health/HealthSection"));

/** What the device has been through, and what became of its data. */
export function Past({ id, lastData }: PastProps) {
  return (
    <>
      <WhenSeen before={<Coming title={t("history.title")} lines={14} />}>
        <HistorySection id={id} lastData={lastData} />
      </WhenSeen>
      <WhenSeen before={<Coming title={t("history.health.title")} lines={10} />}>
        <HealthSection id={id} />
      </WhenSeen>
    </>
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
