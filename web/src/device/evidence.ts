/** The numbers behind an alert, in words. */

const UNITS: Record<string, string> = { deg: "°", s: " s", mps: " m/s", mps2: " m/s²", hz: " Hz", m: " m" };

/** "angle_deg" is "angle", in degrees. */
export function labelled(name: string): { label: string; unit: string } {
  const words = name.split("_");
  const unit = words.length > 1 ? UNITS[words.at(-1) ?? ""] : undefined;
  return { label: (unit ? words.slice(0, -1) : words).join(" "), unit: unit ?? "" };
}

/** Numbers to four digits, lists of them likewise. */
export function shortened(value: unknown): string {
  if (typeof value === "number") return String(Number(value.toPrecision(4)));
  if (Array.isArray(value)) return value.map(shortened).join(", ");
  return typeof value === "string" ? value : JSON.stringify(value);
}
