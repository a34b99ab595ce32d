import type { en, Translated } from "../en";

export const settings: Translated<typeof en.settings> = {};
