/** The stages of an installation, what may be missing in it, and how both are said. */
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

export const STAGES = [
  "waiting",
  "aligning",
  "settling",
  "verifying",
  "confirmed",
] as const satisfies readonly Stage[];

export type Tone = "neutral" | "accent" | "good" | "warn" | "bad";

interface StageText {
  word: string;
  meaning: string;
  tone: Tone;
  icon: LucideIcon;
}

export const STAGE: Record<Stage, StageText> = {
  waiting: { word: "Waiting", meaning: "No usable data yet", tone: "neutral", icon: RadioTower },
  aligning: { word: "Aligning", meaning: "Finding the rough orientation", tone: "accent", icon: Compass },
  settling: { word: "Settling", meaning: "Refining the angles", tone: "accent", icon: SlidersHorizontal },
  verifying: { word: "Verifying", meaning: "Testing the result on the road", tone: "accent", icon: Route },
  confirmed: { word: "Confirmed", meaning: "The mounting is known", tone: "good", icon: CircleCheckBig },
};

export const NEED: Record<Need, { word: string; icon: LucideIcon }> = {
  data: { word: "Data from the device", icon: RadioTower },
  gps_fix: { word: "GPS reception", icon: Satellite },
  motion: { word: "Drive", icon: Car },
  turn: { word: "Turn corners", icon: CornerUpRight },
  accelerate_or_brake: { word: "Accelerate and brake", icon: Gauge },
  time: { word: "A little more time", icon: Hourglass },
};
