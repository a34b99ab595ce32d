import { CircleAlert, Info, TriangleAlert } from "lucide-react";
import { useDeviceAlerts } from "../api/queries";
import { useMay } from "../api/session";
import type { Alert } from "../api/types";
import { ClockTime } from "../components/RelativeTime";
import { Section } from "../components/Section";
import { Failed, Loading } from "../components/States";
import { Notice } from "../components/Tone";
import type { Tone } from "../lib/stages";
import css from "./device.module.css";
import { Evidence } from "./Evidence";
import { beginning } from "./evidence";

const LOOK: Record<Alert["severity"], { tone: Tone; icon: typeof Info }> = {
  info: { tone: "accent", icon: Info },
  warning: { tone: "warn", icon: TriangleAlert },
  critical: { tone: "bad", icon: CircleAlert },
};
const STATE: Record<Alert["state"], string> = {
  open: "Open",
  acknowledged: "Acknowledged",
  resolved: "Resolved",
};

/** What the service found wrong with this device. Managers read the findings, others only how many there are. */
export function AlertsSection({ id, open }: { id: string; open: number }) {
  const manager = useMay("manager");
  return <Section title="Alerts">{manager ? <Alerts id={id} /> : <Count open={open} />}</Section>;
}

function Count({ open }: { open: number }) {
  if (open === 0) return <Nothing />;
  return (
    <Notice tone="warn" icon={TriangleAlert} title={open === 1 ? "One open alert" : `${open} open alerts`}>
      <p>A fleet manager can read what was found.</p>
    </Notice>
  );
}

function Nothing() {
  return <p className={css.quiet}>None.</p>;
}

function Alerts({ id }: { id: string }) {
  const alerts = useDeviceAlerts(id, true);
  if (alerts.isPending) return <Loading what="the alerts" />;
  if (alerts.isError) return <Failed what="the alerts" error={alerts.error} retry={alerts.refetch} />;
  if (alerts.data.items.length === 0) return <Nothing />;
  return (
    <ul className={css.alerts}>
      {alerts.data.items.map((alert) => (
        <li key={alert.id}>
          <AlertNotice alert={alert} />
        </li>
      ))}
    </ul>
  );
}

function AlertNotice({ alert }: { alert: Alert }) {
  const { tone, icon } = LOOK[alert.severity];
  const since = beginning(alert.data);
  const resolved = alert.state === "resolved";
  return (
    <Notice tone={resolved ? "neutral" : tone} icon={icon} title={alert.message}>
      <p className={css.quiet}>
        {STATE[alert.state]} · <ClockTime at={alert.opened_at} />
        {since && (
          <>
            {" "}
            · began <ClockTime at={since} />
          </>
        )}
        {alert.count > 1 && ` · seen ${alert.count} times`}
      </p>
      <Evidence data={alert.data} unfolded={!resolved} />
    </Notice>
  );
}
