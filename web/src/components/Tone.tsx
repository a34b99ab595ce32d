import type { LucideIcon } from "lucide-react";
import type { ReactNode } from "react";
import type { Tone } from "../lib/stages";
import css from "./tone.module.css";

const classes = (...names: (string | undefined)[]) => names.filter(Boolean).join(" ");

/** A word with a colour and an icon: colour alone never carries the meaning. */
export function Pill({ tone, icon: Icon, children }: { tone: Tone; icon?: LucideIcon; children: ReactNode }) {
  return (
    <span className={classes(css.pill, css[tone])}>
      {Icon && <Icon size="1.1em" aria-hidden />}
      {children}
    </span>
  );
}

interface NoticeProps {
  tone: Tone;
  icon: LucideIcon;
  title: string;
  children?: ReactNode;
  /** alert: interrupts a screen reader; status: waits its turn */
  role?: "alert" | "status";
}

export function Notice({ tone, icon: Icon, title, children, role }: NoticeProps) {
  return (
    <div className={classes(css.notice, css[tone])} role={role}>
      <Icon size={22} aria-hidden />
      <div>
        <strong>{title}</strong>
        {children}
      </div>
    </div>
  );
}

interface BarProps {
  /** 0..1 */
  value: number;
  label: string;
  /** what a screen reader says instead of a percentage */
  text?: string;
  tone?: Tone;
}

export function Bar({ value, label, text, tone = "accent" }: BarProps) {
  const percent = Math.round(Math.min(Math.max(value, 0), 1) * 100);
  return (
    <div
      className={classes(css.bar, css[tone])}
      role="progressbar"
      aria-label={label}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={percent}
      aria-valuetext={text}
    >
      <i style={{ width: `${percent}%` }} />
    </div>
  );
}
