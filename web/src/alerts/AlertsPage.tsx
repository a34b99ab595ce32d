import { useTitle } from "../app/title";
import { t } from "../text";

export function AlertsPage() {
  useTitle(t("shell.alerts"));
  return <h1>{t("shell.alerts")}</h1>;
}
