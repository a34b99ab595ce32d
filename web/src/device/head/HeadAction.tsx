import { Button } from "@mantine/core";
import type { LucideIcon } from "lucide-react";
import { Link } from "wouter";
import css from "./head.module.css";

interface HeadActionProps {
  icon: LucideIcon;
  label: string;
  onClick: () => void;
}

/** A button beside the page's title; on a phone only its icon is seen. */
export function HeadAction({ icon: Icon, label, onClick }: HeadActionProps) {
  return (
    <Button variant="default" className={css.action} aria-label={label} title={label} onClick={onClick}>
      <Icon size={20} aria-hidden />
      <span className={css.word}>{label}</span>
    </Button>
  );
}

interface HeadLinkProps {
  icon: LucideIcon;
  label: string;
  to: string;
}

/** The same for another page. */
export function HeadLink({ icon: Icon, label, to }: HeadLinkProps) {
  return (
    <Button
      component={Link}
      href={to}
      variant="default"
      className={css.action}
      aria-label={label}
      title={label}
    >
      <Icon size={20} aria-hidden />
      <span className={css.word}>{label}</span>
    </Button>
  );
}
