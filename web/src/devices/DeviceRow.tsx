import { memo } from "react";
import { Link } from "wouter";
import type { Device } from "../api/types";
import { RelativeTime } from "../components/RelativeTime";
import { Progress, StageBadge } from "../components/StageBadge";
import { Pill } from "../components/Tone";
import { whole } from "../lib/format";
import { t } from "../text";
import { isSilent, SEVERITY, SILENT_LOOK, SUSPECT_LOOK } from "./look";
import type { Roles } from "./roles";
import css from "./table.module.css";

export interface DeviceRowProps {
  device: Device;
  cell: Roles["cell"];
  isTabStop: boolean;
}

/** Drawn anew only when something of this device has changed. */
export const DeviceRow = memo(function DeviceRow({ device, cell, isTabStop }: DeviceRowProps) {
  const { id, name, vehicle, stage, progress } = device;
  return (
    <div className={`${css.row} ${css.columns}`}>
      <div {...cell} className={css.name} title={name}>
        <Link href={`/devices/${encodeURIComponent(id)}`} tabIndex={isTabStop ? 0 : -1}>
          {name}
        </Link>
      </div>
      <div {...cell} className={css.id} title={id}>
        {id}
      </div>
      <div {...cell} className={css.vehicle} title={vehicle ?? undefined}>
        {vehicle ?? <span className={css.unknown}>{t("common.unknown")}</span>}
      </div>
      <div {...cell} className={css.stage}>
        <StageBadge stage={stage} />
        <Progress stage={stage} progress={progress} />
      </div>
      <div {...cell} className={css.last}>
        <LastData at={device.last_data_at} />
      </div>
      <div {...cell} className={css.alerts}>
        <Alerts device={device} />
      </div>
    </div>
  );
});

function LastData({ at }: { at: string | null }) {
  if (at === null) return t("devices.no_data");
  if (!isSilent(at, Date.now())) return <RelativeTime at={at} />;
  return (
    <Pill {...SILENT_LOOK}>
      <span className="visually-hidden">{t("devices.is_silent")} </span>
      <RelativeTime at={at} />
    </Pill>
  );
}

function Alerts({ device: { open_alerts, mount_status } }: { device: Device }) {
  const isSuspect = mount_status === "suspect";
  if (open_alerts === 0 && !isSuspect) return <span className={css.unknown}>{t("common.none")}</span>;
  return (
    <>
      {isSuspect && <Pill {...SUSPECT_LOOK}>{t("devices.is_suspect")}</Pill>}
      {open_alerts > 0 && (
        <Pill {...SEVERITY.warning}>
          <span aria-hidden>{whole(open_alerts)}</span>
          <span className="visually-hidden">{t("devices.open_alerts", { count: open_alerts })}</span>
        </Pill>
      )}
    </>
  );
}

/** In the place of a row that is not there yet. */
export function Coming({ cell }: { cell: Roles["cell"] }) {
  return (
    <div className={`${css.row} ${css.coming}`}>
      <span {...cell}>
        <i aria-hidden />
        <span className="visually-hidden">{t("devices.row_coming")}</span>
      </span>
    </div>
  );
}
