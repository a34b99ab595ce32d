import type { ReactNode } from "react";
import type { Tone } from "../lib/stages";
import css from "./ring.module.css";

interface RingProps {
  /** 0..1 */
  value: number;
  label: string;
  /** what a screen reader says instead of a percentage */
  text?: string;
  tone?: Tone;
  /** what stands inside */
  children: ReactNode;
}

/** A share as a ring that closes. It is drawn in hundredths of its length. */
export function Ring({ value, label, text, tone = "accent", children }: RingProps) {
  const percent = Math.round(100 * Math.min(Math.max(value, 0), 1));
  return (
    <div
      className={css.ring}
      data-tone={tone}
      role="progressbar"
      aria-label={label}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={percent}
      aria-valuetext={text}
    >
      <svg viewBox="0 0 40 40" aria-hidden="true">
        <circle className={css.ground} cx="20" cy="20" r="17" />
        <circle
          className={css.share}
          cx="20"
          cy="20"
          r="17"
          pathLength="100"
          strokeDasharray={`${percent} 101`}
        />
      </svg>
      <div aria-hidden="true">{children}</div>
    </div>
  );
}
