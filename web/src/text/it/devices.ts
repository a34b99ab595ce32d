import type { en, Translated } from "../en";

export const devices: Translated<typeof en.devices> = {};
