import { TriangleAlert } from "lucide-react";
import { Link } from "wouter";
import type { Device } from "../api/types";
import { RelativeTime } from "../components/RelativeTime";
import { Progress, StageBadge } from "../components/StageBadge";
import { Pill } from "../components/Tone";
import css from "./devices.module.css";

/** A table on a wide screen, the same rows as cards on a phone. */
export function DeviceList({ devices, stale }: { devices: readonly Device[]; stale: boolean }) {
  return (
    <div className={css.list} data-stale={stale || undefined}>
      <div className={css.titles} aria-hidden>
        <span>Device</span>
        <span>Vehicle</span>
        <span>Stage</span>
        <span>Last data</span>
        <span>Alerts</span>
      </div>
      <ul aria-label="Devices" aria-busy={stale}>
        {devices.map((device) => (
          <li key={device.id}>
            <Row device={device} />
          </li>
        ))}
      </ul>
    </div>
  );
}

function Row({ device }: { device: Device }) {
  return (
    <div className={css.row}>
      <div className={css.name}>
        <Link href={`/devices/${encodeURIComponent(device.id)}`}>{device.name}</Link>
        <span>{device.id}</span>
      </div>
      <div className={css.vehicle}>{device.vehicle ?? <span className={css.unknown}>–</span>}</div>
      <div className={css.stage}>
        <StageBadge stage={device.stage} />
        <Progress stage={device.stage} progress={device.progress} />
      </div>
      <div className={css.last}>
        {device.last_data_at ? <RelativeTime at={device.last_data_at} /> : "No data yet"}
      </div>
      <div className={css.alerts}>
        <Alerts device={device} />
      </div>
    </div>
  );
}

function Alerts({ device }: { device: Device }) {
  if (device.open_alerts === 0) return <span className={css.none}>None</span>;
  return (
    <Pill tone={device.mount_status === "suspect" ? "bad" : "warn"} icon={TriangleAlert}>
      {device.mount_status === "suspect" ? "Moved" : device.open_alerts}
      <span className="visually-hidden"> open alerts</span>
    </Pill>
  );
}
