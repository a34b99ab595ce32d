/** A short history, for tests. */
import type { Estimates, Stage } from "../../api/types";

export const START = Date.parse("2025-11-22T10:00:00Z") / 1000;

interface Row {
  t: number;
  yaw?: number;
  sigma?: number;
  session?: string;
  stage?: Stage;
}

export function estimates(rows: Row[]): Estimates {
  const fill = <T>(value: T) => rows.map(() => value);
  return {
    session: rows.map(({ session }) => session ?? "s"),
    t: rows.map(({ t }) => t),
    time: rows.map(({ t }) => new Date((START + t) * 1000).toISOString()),
    quaternion: fill([1, 0, 0, 0]),
    angles_deg: { roll: fill(0), pitch: fill(1), yaw: rows.map(({ yaw }) => yaw ?? 0) },
    sigma_deg: rows.map(({ sigma }) => [0.1, 0.2, sigma ?? 0.5]),
    stage: rows.map(({ stage }) => stage ?? "settling"),
    stable: fill(false),
    reliable: fill(false),
    progress: fill(0.5),
  };
}
