import { useDocumentVisibility } from "@mantine/hooks";
import { useEffect } from "react";
import { useSearchParams } from "wouter";
import { useUnread } from "../api/unread";
import { useTitle } from "../app/title";
import { t } from "../text";
import { AlertList } from "./AlertList";
import css from "./alerts.module.css";
import { Filters } from "./Filters";
import { fromAddress, toAddress } from "./filters";
import { OneAlert } from "./OneAlert";

/** What the service found wrong over the fleet. `?id=` shows one alert, as webhook receivers link to it. */
export function AlertsPage() {
  useTitle(t("shell.alerts"));
  useLookedAt();
  const [address, setAddress] = useSearchParams();
  const filter = fromAddress(address);
  const id = Number(address.get("id"));
  if (Number.isInteger(id) && id > 0) return <OneAlert key={id} id={id} />;
  return (
    <div className={css.page}>
      <h1>{t("shell.alerts")}</h1>
      <Filters filter={filter} onChange={(next) => setAddress(toAddress(next), { replace: true })} />
      <AlertList filter={filter} onClear={() => setAddress({})} />
    </div>
  );
}

/** Whoever has this page before them has seen what is unread. */
function useLookedAt(): void {
  const { unread, markSeen } = useUnread();
  const visible = useDocumentVisibility() === "visible";
  useEffect(() => {
    if (visible && unread.length > 0) markSeen();
  });
}
