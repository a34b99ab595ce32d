/** For tests: an installation that is being calibrated, and what the device sends. */
import type { Installation, LastData } from "../api/types";

export const NOW = new Date("2025-11-22T10:01:10Z");

export const lastData = (over: Partial<LastData> = {}): LastData => ({
  session: "a",
  sample_rate_hz: 100,
  fix_rate_hz: 5,
  has_fix: true,
  speed_mps: 11.7,
  gyroscope: true,
  span_s: 60,
  rejected: {},
  ...over,
});

export const installation = (over: Partial<Installation> = {}): Installation => ({
  device_id: "a",
  stage: "settling",
  since: "2025-11-22T10:00:00Z",
  progress: 0.5,
  needs: ["turn"],
  hint: "In the service's words.",
  estimate: null,
  verification: { state: "idle", elapsed_s: 0, duration_s: 40, error_mps: null, limit_mps: 2.5, trace: null },
  mount: null,
  limits: { yaw_sigma_deg: 1.5, tilt_sigma_deg: 1.3 },
  open_alerts: 0,
  last_data_at: "2025-11-22T10:01:00Z",
  data: lastData(),
  revision: 7,
  ...over,
});

export const mount = (status: "in_force" | "suspect"): NonNullable<Installation["mount"]> => ({
  id: 1,
  quaternion: [1, 0, 0, 0],
  matrix: [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ],
  angles_deg: { roll: 0, pitch: 0, yaw: 0 },
  sigma_deg: [0.3, 0.3, 0.4],
  confirmed_at: "2025-11-22T09:40:30Z",
  status,
  verification: {
    state: "passed",
    elapsed_s: 40,
    duration_s: 40,
    error_mps: 0.5,
    limit_mps: 2.5,
    trace: null,
  },
});
