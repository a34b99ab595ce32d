import type { en, Translated } from "../en";

export const device: Translated<typeof en.device> = {};
