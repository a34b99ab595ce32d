import { CircleAlert, Info, TriangleAlert } from "lucide-react";
import { useDeviceAlerts } from "../api/queries";
import { useMay } from "../api/session";
import type { Alert } from "../api/types";
import { ClockTime } from "../components/RelativeTime";
import { Section } from "../components/Section";
import { Failed, Loading } from "../components/States";
import { Notice } from "../components/Tone";
import type { Tone } from "../lib/stages";
import { Trans, t } from "../text";
import css from "./alerts.module.css";
import { Evidence } from "./Evidence";
import { beginning } from "./evidence";

const LOOK: Record<Alert["severity"], { tone: Tone; icon: typeof Info }> = {
  info: { tone: "accent", icon: Info },
  warning: { tone: "warn", icon: TriangleAlert },
  critical: { tone: "bad", icon: CircleAlert },
};

/** What the service found wrong with this device. Managers read the findings, others only how many there are. */
export function AlertsSection({ id, open }: { id: string; open: number }) {
  const manager = useMay("manager");
  return (
    <Section title={t("history.alert.title")}>{manager ? <Alerts id={id} /> : <Count open={open} />}</Section>
  );
}

function Count({ open }: { open: number }) {
  if (open === 0) return <Nothing />;
  const title = t("history.alert.open", { count: open, number: open });
  return (
    <Notice tone="warn" icon={TriangleAlert} title={title}>
      <p>{t("history.alert.ask_manager")}</p>
    </Notice>
  );
}

function Nothing() {
  return <p className={css.quiet}>{t("history.alert.none")}</p>;
}

function Alerts({ id }: { id: string }) {
  const alerts = useDeviceAlerts(id, true);
  const what = t("history.alert.the_alerts");
  if (alerts.isPending) return <Loading what={what} />;
  if (alerts.isError) return <Failed what={what} error={alerts.error} retry={alerts.refetch} />;
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

function AlertNotice({
  alert: { severity, state, message, opened_at, count, kind, data },
}: {
  alert: Alert;
}) {
  const { tone, icon } = LOOK[severity];
  const since = beginning(data);
  const resolved = state === "resolved";
  return (
    <Notice tone={resolved ? "neutral" : tone} icon={icon} title={message}>
      <p className={css.facts}>
        <span>{t(`history.alert.state.${state}`)}</span>
        <ClockTime at={opened_at} />
        {since && (
          <span>
            <Trans i18nKey="history.alert.began" components={{ when: <ClockTime at={since} /> }} />
          </span>
        )}
        {count > 1 && <span>{t("history.alert.seen", { count, number: count })}</span>}
      </p>
      <Evidence kind={kind} data={data} unfolded={!resolved} />
    </Notice>
  );
}
