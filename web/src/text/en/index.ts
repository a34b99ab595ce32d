/** English, a file for each room of the page. */
import { alerts } from "./alerts";
import { common } from "./common";
import { device } from "./device";
import { devices } from "./devices";
import { history } from "./history";
import { motion } from "./motion";
import { mounting } from "./mounting";
import { settings } from "./settings";
import { shell } from "./shell";

export const en = { alerts, common, device, devices, history, motion, mounting, settings, shell } as const;

/** The same texts in another language: every one of them, and no other. */
export type Translated<T> = { [K in keyof T]: T[K] extends string ? string : Translated<T[K]> };
