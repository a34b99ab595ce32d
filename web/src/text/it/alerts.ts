import type { en, Translated } from "../en";

export const alerts: Translated<typeof en.alerts> = {};
