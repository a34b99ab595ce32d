import { useMemo } from "react";
import { qrDrawing } from "../lib/qr";

export interface QrProps {
  text: string;
  /** what it leads to or holds, for those who cannot see it */
  label: string;
  /** CSS pixels along a side */
  size?: number;
}

/** Black on white in both colour schemes: many readers do not know the inverse. */
export default function QrSvg({ text, label, size }: QrProps) {
  const { side, path } = useMemo(() => qrDrawing(text), [text]);
  return (
    <svg
      role="img"
      aria-label={label}
      width={size}
      height={size}
      viewBox={`0 0 ${side} ${side}`}
      shapeRendering="crispEdges"
      style={{ forcedColorAdjust: "none" }}
    >
      <rect width={side} height={side} fill="#fff" />
      <path d={path} fill="#000" />
    </svg>
  );
}
