/** The numbers the service decides by, as people write them. */
import type { Threshold } from "../api/types";
import { significant, whole } from "../lib/format";
import { t } from "../text";

const EXPONENTS: Record<string, string> = { "2": "²", "3": "³" };

export function valueText({ value, unit }: Pick<Threshold, "value" | "unit">): string {
  if (value === "infinite") return t("settings.thresholds.infinite");
  const text = typeof value === "number" ? numberText(value) : value;
  return unit === "deg" ? `${text}°` : `${text} ${unitText(unit)}`.trim();
}

/** Whole numbers to the last digit: bytes are counted. */
function numberText(value: number): string {
  return Number.isInteger(value) ? whole(value) : significant(value, 4);
}

/** "deg/s" is "°/s", "m2/s3" is "m²/s³". */
function unitText(unit: string): string {
  return unit.replace("deg", "°").replace(/(?<=[a-z])[23]/g, (digit) => EXPONENTS[digit] ?? digit);
}
