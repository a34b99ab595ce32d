/** Italiano. */
import type { en, Translated } from "../en";
import { alerts } from "./alerts";
import { common } from "./common";
import { device } from "./device";
import { devices } from "./devices";
import { history } from "./history";
import { motion } from "./motion";
import { mounting } from "./mounting";
import { settings } from "./settings";
import { shell } from "./shell";

export const it: Translated<typeof en> = {
  alerts,
  common,
  device,
  devices,
  history,
  motion,
  mounting,
  settings,
  shell,
};
