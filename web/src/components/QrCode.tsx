import { Suspense } from "react";
import { optional } from "./optional";
import type { QrProps } from "./QrSvg";

/** The encoder comes only where a code is shown; the text stands beside it. */
const QrSvg = optional(() => import("./QrSvg"));

/** A text as a QR code, to be read by a phone's camera. */
export function QrCode({ text, label, size = 176 }: QrProps) {
  return (
    <Suspense fallback={<svg width={size} height={size} aria-hidden="true" />}>
      <QrSvg text={text} label={label} size={size} />
    </Suspense>
  );
}
