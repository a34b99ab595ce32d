import type { en, Translated } from "../en";

export const history: Translated<typeof en.history> = {};
