import { type ReactNode, useId } from "react";
import css from "./section.module.css";

interface SectionProps {
  title: string;
  /** controls or a short remark beside the title */
  aside?: ReactNode;
  children: ReactNode;
  className?: string;
}

/** One card of a page, named by its heading. */
export function Section({ title, aside, children, className }: SectionProps) {
  const id = useId();
  return (
    <section className={["card", className].filter(Boolean).join(" ")} aria-labelledby={id}>
      <header className={css.head}>
        <h2 id={id}>{title}</h2>
        {aside}
      </header>
      {children}
    </section>
  );
}
