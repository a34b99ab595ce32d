import { useTitle } from "../app/title";
import { t } from "../text";

export function SettingsPage() {
  useTitle(t("shell.settings"));
  return <h1>{t("shell.settings")}</h1>;
}
