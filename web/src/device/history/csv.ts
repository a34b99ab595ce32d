/** The angle history as a table for other programs: decimal points and UTC, whatever the reader's language. */
import type { Estimates } from "../../api/types";

const COLUMNS: readonly [string, (estimates: Estimates, row: number) => unknown][] = [
  ["time_utc", ({ time }, row) => new Date(time[row] ?? "").toISOString()],
  ["session", ({ session }, row) => asText(session[row] ?? "")],
  ["t_s", ({ t }, row) => t[row]],
  ["roll_deg", ({ angles_deg }, row) => angles_deg.roll[row]],
  ["pitch_deg", ({ angles_deg }, row) => angles_deg.pitch[row]],
  ["yaw_deg", ({ angles_deg }, row) => angles_deg.yaw[row]],
  ["roll_sigma_deg", ({ sigma_deg }, row) => sigma_deg[row]?.[0]],
  ["pitch_sigma_deg", ({ sigma_deg }, row) => sigma_deg[row]?.[1]],
  ["yaw_sigma_deg", ({ sigma_deg }, row) => sigma_deg[row]?.[2]],
  ["q_w", ({ quaternion }, row) => quaternion[row]?.[0]],
  ["q_x", ({ quaternion }, row) => quaternion[row]?.[1]],
  ["q_y", ({ quaternion }, row) => quaternion[row]?.[2]],
  ["q_z", ({ quaternion }, row) => quaternion[row]?.[3]],
  ["stage", ({ stage }, row) => stage[row]],
  ["stable", ({ stable }, row) => stable[row]],
  ["reliable", ({ reliable }, row) => reliable[row]],
  ["progress", ({ progress }, row) => progress[row]],
];

export function csvText(estimates: Estimates): string {
  const header = COLUMNS.map(([name]) => name).join(",");
  const rows = estimates.time.map((_, row) => COLUMNS.map(([, value]) => value(estimates, row)).join(","));
  return `${[header, ...rows].join("\r\n")}\r\n`;
}

/** Quoted where it must be. What a spreadsheet would take for a formula is put behind an apostrophe. */
function asText(value: string): string {
  const safe = /^[=+\-@]/.test(value) ? `'${value}` : value;
  return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

/** "livella-van-7-20251122T100000Z-20251122T110000Z.csv" */
export function csvName(id: string, { time }: Estimates): string {
  const ends = [time[0], time.at(-1)].map((moment) => compact(moment ?? ""));
  return `livella-${id}-${ends.join("-")}.csv`;
}

function compact(moment: string): string {
  return `${new Date(moment).toISOString().slice(0, 19).replaceAll(/[-:]/g, "")}Z`;
}

/** Let the browser store a text as a file. */
export function save(name: string, text: string): void {
  const url = URL.createObjectURL(new Blob([text], { type: "text/csv;charset=utf-8" }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  URL.revokeObjectURL(url);
}
