/** Which mounting the page shows: the confirmed one while it holds, else the best that is known so far. */
import type { Estimate, Installation, Mount } from "../api/types";
import { type Quaternion, toQuaternion } from "../lib/rotation";

export interface Shown {
  quaternion: Quaternion;
  angles: Estimate["angles_deg"];
  matrix: Estimate["matrix"];
  /** degrees about the vehicle's x, y and z axes */
  sigma: Estimate["sigma_deg"];
  /** the confirmed mounting this is, or null for an estimate */
  mount: Mount | null;
}

export function shownMounting({ mount, estimate }: Installation): Shown | null {
  if (mount?.status === "in_force") return shown(mount, mount);
  if (estimate) return shown(estimate, null);
  return mount && shown(mount, mount);
}

function shown(source: Mount | Estimate, mount: Mount | null): Shown {
  return {
    quaternion: toQuaternion(source.quaternion),
    angles: source.angles_deg,
    matrix: source.matrix,
    sigma: source.sigma_deg,
    mount,
  };
}

/** For programs: points before decimals in every language. */
export function quaternionText(quaternion: Quaternion): string {
  return quaternion.map((value) => value.toFixed(6)).join(", ");
}
