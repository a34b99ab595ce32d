/** What to do now: one sentence for a driver, and what else is needed. */
import type { Installation, Need } from "../../api/types";
import { NEED_ICON } from "../../lib/stages";
import { t } from "../../text";

export interface Instruction {
  say: string;
  /** needs that the sentence does not speak of */
  also: Need[];
}

type Told = Pick<Installation, "stage" | "needs" | "hint" | "last_data_at">;

/** The most urgent need as a sentence; the service's own where it names a need that this page does not know. */
export function instruction({ stage, needs, hint, last_data_at }: Told, silent: boolean): Instruction {
  if (stage === "confirmed") return { say: t("device.now.confirmed"), also: [] };
  const known = URGENCY.filter((need) => needs.includes(need));
  const [first] = known;
  if (silent) return { say: t("device.now.silent"), also: known.filter((need) => need !== "data") };
  if (known.length < needs.length || first === undefined) return { say: hint, also: known };
  return { say: sentence(first, stage, last_data_at !== null), also: known.slice(1) };
}

/** The order in which needs are told: without the first ones the others cannot be met. */
const URGENCY = Object.keys(NEED_ICON) as Need[];

function sentence(need: Need, stage: Installation["stage"], heardOf: boolean): string {
  if (need === "data" && heardOf) return t("device.now.data_again");
  if (need === "time" && stage === "verifying") return t("device.now.verifying");
  return t(`device.now.${need}`);
}
