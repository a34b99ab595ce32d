/** When the page offers to take it that the vehicle stands on level ground. */
import type { Installation } from "../../api/types";

/** Helps until the mounting is confirmed; a device that has never sent anything cannot show that it stands still. */
export function levelHelps({ stage, last_data_at }: Pick<Installation, "stage" | "last_data_at">): boolean {
  return stage !== "confirmed" && last_data_at !== null;
}
