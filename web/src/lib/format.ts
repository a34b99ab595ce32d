/** Numbers for people, as the reader's region writes them. */
import { locale } from "../text";

/** A number with so many decimals: a real minus sign, and no minus before zero. */
export function fixed(value: number, digits: number): string {
  const options = {
    minimumFractionDigits: digits,
    maximumFractionDigits: digits,
    signDisplay: "negative",
  } as const;
  return signed(new Intl.NumberFormat(locale(), options).format(value));
}

/** A count: "12,345". */
export function whole(value: number): string {
  return fixed(value, 0);
}

/** To so many significant digits: "0.0123", "1,230". */
export function significant(value: number, digits: number): string {
  const options = { maximumSignificantDigits: digits, signDisplay: "negative" } as const;
  return signed(new Intl.NumberFormat(locale(), options).format(value));
}

/** A share, 0..1: "42%". */
export function percent(share: number): string {
  return new Intl.NumberFormat(locale(), { style: "percent" }).format(share);
}

/** "3.4°" below ten degrees, "94°" above. */
export function degreesText(degrees: number): string {
  return `${fixed(degrees, Math.abs(degrees) < 9.95 ? 1 : 0)}°`;
}

/** "a, b and c" in the reader's language. */
export function listed(parts: readonly string[]): string {
  return new Intl.ListFormat(locale(), { type: "conjunction" }).format(parts);
}

function signed(text: string): string {
  return text.replace("-", "\u2212");
}
