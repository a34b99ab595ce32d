/** A QR code as one path of squares, so that it can be drawn as sharp as any paper or screen is. */
import { encodeQR } from "qr";

/** Modules of white around the code, which readers need to find it (ISO/IEC 18004). */
const QUIET_ZONE = 4;

export interface QrDrawing {
  /** modules along a side, with the quiet zone */
  side: number;
  /** the dark modules, in units of one module */
  path: string;
}

export function qrDrawing(text: string): QrDrawing {
  const rows = encodeQR(text, "raw", { border: QUIET_ZONE, ecc: "medium" });
  return { side: rows.length, path: rows.map(darkRuns).join("") };
}

/** Neighbours are drawn as one bar: between squares a reader's anti-aliasing would leave hairlines. */
function darkRuns(row: readonly boolean[], y: number): string {
  return row
    .map((dark, x) => (dark && !row[x - 1] ? `M${x} ${y}h${runLength(row, x)}v1h-${runLength(row, x)}z` : ""))
    .join("");
}

function runLength(row: readonly boolean[], from: number): number {
  const end = row.indexOf(false, from);
  return (end < 0 ? row.length : end) - from;
}
