/** How severities and states are shown: a colour, an icon and a word each. */
import { BellRing, CircleAlert, CircleCheck, Eye, Info, type LucideIcon, TriangleAlert } from "lucide-react";
import type { AlertState, Severity } from "../api/types";
import type { Tone } from "../lib/stages";

interface Look {
  tone: Tone;
  icon: LucideIcon;
}

export const SEVERITY: Record<Severity, Look> = {
  info: { tone: "accent", icon: Info },
  warning: { tone: "warn", icon: TriangleAlert },
  critical: { tone: "bad", icon: CircleAlert },
};

export const STATE: Record<AlertState, Look> = {
  open: { tone: "accent", icon: BellRing },
  acknowledged: { tone: "neutral", icon: Eye },
  resolved: { tone: "good", icon: CircleCheck },
};
