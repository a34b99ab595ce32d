/** How alerts look in the list and on its tiles: never by colour alone. */
import { Info, type LucideIcon, OctagonAlert, Rotate3d, TriangleAlert, WifiOff } from "lucide-react";
import type { Severity } from "../api/types";
import type { Tone } from "../lib/stages";

interface Look {
  tone: Tone;
  icon: LucideIcon;
}

export const SEVERITY: Record<Severity, Look> = {
  critical: { tone: "bad", icon: OctagonAlert },
  warning: { tone: "warn", icon: TriangleAlert },
  info: { tone: "accent", icon: Info },
};
export const SILENT_LOOK: Look = { tone: "warn", icon: WifiOff };
export const SUSPECT_LOOK: Look = { tone: "bad", icon: Rotate3d };

/** h; the service raises its alert after this long, unless it is set otherwise. */
const SILENT_AFTER = 72;

/** Has a device that has sent before been quiet for long? */
export function isSilent(lastDataAt: string, now: number): boolean {
  return now - Date.parse(lastDataAt) > SILENT_AFTER * 3_600_000;
}
