import { needed } from "../components/needed";
import { Section } from "../components/Section";
import { Loading } from "../components/States";
import { WhenSeen } from "../components/WhenSeen";
import { t } from "../text";

interface PastProps {
  id: string;
  lastData: string | null;
}

const HistorySection = needed(
  () => t("history.the_history"),
  () => import("./history/HistorySection"),
);
const HealthSection = needed(
  () => t("history.health.the_health"),
  () => import("./health/HealthSection"),
);

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
