import { Anchor, Button } from "@mantine/core";
import { useState } from "react";
import { Link } from "wouter";
import { AlertCard } from "../alerts/AlertCard";
import { useDeviceAlerts } from "../api/queries";
import type { Alert } from "../api/types";
import { Failed, Loading } from "../components/States";
import { whole } from "../lib/format";
import { t } from "../text";
import css from "./alerts.module.css";

/** Shown of those that are over, before somebody asks for more. */
const FEW = 3;

/** The alerts of one device, newest first, as managers see them. */
export default function DeviceAlerts({ id }: { id: string }) {
  const alerts = useDeviceAlerts(id, true);
  const what = t("history.alert.the_alerts");
  if (alerts.isPending) return <Loading what={what} />;
  if (alerts.isError) return <Failed what={what} error={alerts.error} retry={alerts.refetch} />;
  const { items, next_cursor } = alerts.data;
  if (items.length === 0) return <p className={css.quiet}>{t("history.alert.none")}</p>;
  return (
    <>
      <Cards alerts={items} />
      {next_cursor && (
        <Anchor component={Link} href={`/alerts?device=${encodeURIComponent(id)}&state=all`}>
          {t("history.alert.all")}
        </Anchor>
      )}
    </>
  );
}

function Cards({ alerts }: { alerts: readonly Alert[] }) {
  const [all, setAll] = useState(false);
  const shown = alerts.filter(({ state }, place) => all || place < FEW || state !== "resolved");
  const hidden = alerts.length - shown.length;
  return (
    <>
      <ul className={css.alerts}>
        {shown.map((alert) => (
          <li key={alert.id}>
            <AlertCard alert={alert} showDevice={false} unfolded={alert.state === "open"} />
          </li>
        ))}
      </ul>
      {hidden > 0 && (
        <Button variant="subtle" mt="sm" onClick={() => setAll(true)}>
          {t("history.more", { count: hidden, number: whole(hidden) })}
        </Button>
      )}
    </>
  );
}
