import { Anchor } from "@mantine/core";
import { ArrowLeft } from "lucide-react";
import type { ReactNode } from "react";
import { Link } from "wouter";
import css from "../device/head/head.module.css";

interface PageHeadProps {
  back: string;
  backTo: string;
  title: string;
  facts: ReactNode;
  actions?: ReactNode;
}

export function PageHead({ back, backTo, title, facts, actions }: PageHeadProps) {
  return (
    <header className={css.head}>
      <Anchor component={Link} href={back} className={css.back}>
        <ArrowLeft size={18} aria-hidden /> {backTo}
      </Anchor>
      <div className={css.title}>
        <h1>{title}</h1>
        <p className={css.facts}>{facts}</p>
      </div>
      {actions && <div className={css.actions}>{actions}</div>}
    </header>
  );
}
