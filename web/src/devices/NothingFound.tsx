import { Button } from "@mantine/core";
import { Search, X } from "lucide-react";
import type { DeviceFilter } from "../api/keys";
import { Empty } from "../components/States";
import { stageWord } from "../lib/stages";
import { t } from "../text";
import css from "./devices.module.css";
import { EVERYTHING, type Restriction, restrictions } from "./filter";
import type { Change } from "./useFilter";

/** Which restrictions leave nothing over; each can be taken away by itself. */
export function NothingFound({ filter, onChange }: { filter: DeviceFilter; onChange: Change }) {
  return (
    <div className="card" role="status">
      <Empty icon={Search} title={t("devices.nothing.title")}>
        <p>{t("devices.nothing.about")}</p>
        <div className={css.restrictions}>
          {restrictions(filter).map((name) => (
            <Button
              key={name}
              variant="light"
              rightSection={<X size={18} aria-hidden />}
              aria-label={t("devices.nothing.remove", { filter: words(filter, name) })}
              onClick={() => onChange({ [name]: "" })}
            >
              {words(filter, name)}
            </Button>
          ))}
          <Button variant="default" onClick={() => onChange({ ...EVERYTHING, sort: filter.sort })}>
            {t("devices.nothing.clear")}
          </Button>
        </div>
      </Empty>
    </div>
  );
}

function words(filter: DeviceFilter, name: Restriction): string {
  return t(`devices.nothing.${name}`, { value: valueWord(filter, name) });
}

function valueWord(filter: DeviceFilter, name: Restriction): string {
  if (name === "stage" && filter.stage) return stageWord(filter.stage);
  if (name === "alert_severity" && filter.alert_severity) {
    return t(`devices.severity.${filter.alert_severity}`);
  }
  if (name === "alert_kind") return t("devices.silent");
  return name === "mount_status" ? t("devices.is_suspect") : filter.q.trim();
}
