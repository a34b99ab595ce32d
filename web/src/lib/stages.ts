/** The stages of an installation and what may be missing in it, and how both are shown. */
import {
  Car,
  CircleCheckBig,
  Compass,
  CornerUpRight,
  Gauge,
  Hourglass,
  type LucideIcon,
  RadioTower,
  Route,
  Satellite,
  SlidersHorizontal,
} from "lucide-react";
import type { Need, Stage } from "../api/types";
import { t } from "../text";

export const STAGES = [
  "waiting",
  "aligning",
  "settling",
  "verifying",
  "confirmed",
] as const satisfies readonly Stage[];

export type Tone = "neutral" | "accent" | "good" | "warn" | "bad";

interface StageLook {
  tone: Tone;
  icon: LucideIcon;
}

export const STAGE: Record<Stage, StageLook> = {
  waiting: { tone: "neutral", icon: RadioTower },
  aligning: { tone: "accent", icon: Compass },
  settling: { tone: "accent", icon: SlidersHorizontal },
  verifying: { tone: "accent", icon: Route },
  confirmed: { tone: "good", icon: CircleCheckBig },
};

export const stageWord = (stage: Stage): string => t(`common.stage.${stage}`);
export const stageMeaning = (stage: Stage): string => t(`common.stage_meaning.${stage}`);

export const NEED_ICON: Record<Need, LucideIcon> = {
  data: RadioTower,
  gps_fix: Satellite,
  motion: Car,
  turn: CornerUpRight,
  accelerate_or_brake: Gauge,
  time: Hourglass,
};
