import { type ComponentType, lazy, Suspense } from "react";
import type { QrProps } from "./QrSvg";

/** The encoder comes only where a code is shown. Where it does not come nothing is lost: the text stands beside it. */
const QrSvg = lazy<ComponentType<QrProps>>(() => import("./QrSvg").catch(() => ({ default: () => null })));

/** A text as a QR code, to be read by a phone's camera. */
export function QrCode({ text, label, size = 176 }: QrProps) {
  return (
    <Suspense fallback={<svg width={size} height={size} aria-hidden="true" />}>
      <QrSvg text={text} label={label} size={size} />
    </Suspense>
  );
}
