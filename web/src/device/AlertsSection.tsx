import { TriangleAlert } from "lucide-react";
import { useMay } from "../api/session";
import { needed } from "../components/needed";
import { Section } from "../components/Section";
import { Loading } from "../components/States";
import { Notice } from "../components/Tone";
import { WhenSeen } from "../components/WhenSeen";
import { whole } from "../lib/format";
import { t } from "../text";
import css from "./alerts.module.css";

const DeviceAlerts = needed(
  () => t("history.alert.the_alerts"),
  () => import("./DeviceAlerts"),
);

/** What the service found wrong with this device. Managers read the findings, others only how many there are. */
export function AlertsSection({ id, open }: { id: string; open: number }) {
  const manager = useMay("manager");
  return (
    <Section title={t("history.alert.title")}>
      {manager ? (
        <WhenSeen before={<Loading what={t("history.alert.the_alerts")} />}>
          <DeviceAlerts id={id} />
        </WhenSeen>
      ) : (
        <Count open={open} />
      )}
    </Section>
  );
}

function Count({ open }: { open: number }) {
  if (open === 0) return <p className={css.quiet}>{t("history.alert.none")}</p>;
  const title = t("history.alert.open", { count: open, number: whole(open) });
  return (
    <Notice tone="warn" icon={TriangleAlert} title={title}>
      <p>{t("history.alert.ask_manager")}</p>
    </Notice>
  );
}
