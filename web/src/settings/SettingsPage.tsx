import { type ComponentType, lazy, Suspense, useId } from "react";
import { Link, Redirect, useRoute } from "wouter";
import { atLeast, useSession } from "../api/session";
import type { Role } from "../api/types";
import { useTitle } from "../app/title";
import { Loading } from "../components/States";
import { t } from "../text";
import css from "./settings.module.css";

const AboutPage = lazy(() => import("./AboutPage").then((m) => ({ default: m.AboutPage })));
const AuditPage = lazy(() => import("./AuditPage").then((m) => ({ default: m.AuditPage })));
const KeysPage = lazy(() => import("./KeysPage").then((m) => ({ default: m.KeysPage })));
const ThresholdsPage = lazy(() => import("./ThresholdsPage").then((m) => ({ default: m.ThresholdsPage })));
const WebhooksPage = lazy(() => import("./WebhooksPage").then((m) => ({ default: m.WebhooksPage })));

interface Place {
  name: "keys" | "webhooks" | "thresholds" | "audit" | "about";
  /** who the service lets read it */
  needed: Role;
  page: ComponentType;
}

const PLACES: readonly Place[] = [
  { name: "webhooks", needed: "manager", page: WebhooksPage },
  { name: "thresholds", needed: "manager", page: ThresholdsPage },
  { name: "keys", needed: "admin", page: KeysPage },
  { name: "audit", needed: "admin", page: AuditPage },
  { name: "about", needed: "installer", page: AboutPage },
];

/** What may be set and looked up, each to whom it concerns. */
export function SettingsPage() {
  const { data: session } = useSession();
  const [, params] = useRoute("/settings/*?");
  const allowed = PLACES.filter(({ needed }) => session && atLeast(session.role, needed));
  const place = allowed.find(({ name }) => name === params?.["*"]);
  const [first] = allowed;
  if (!place) return first ? <Redirect to={`/settings/${first.name}`} replace /> : null;
  return <Shown place={place} allowed={allowed} />;
}

function Shown({ place, allowed }: { place: Place; allowed: readonly Place[] }) {
  const title = t(`settings.place.${place.name}`);
  const heading = useId();
  useTitle(title);
  const { page: Page } = place;
  return (
    <div className={css.page}>
      <h1>{t("shell.settings")}</h1>
      <nav className={css.places} aria-label={t("settings.sections")}>
        {allowed.map(({ name }) => (
          <Link key={name} href={`/settings/${name}`} aria-current={name === place.name ? "page" : undefined}>
            {t(`settings.place.${name}`)}
          </Link>
        ))}
      </nav>
      <section className={css.content} aria-labelledby={heading}>
        <h2 id={heading}>{title}</h2>
        <Suspense fallback={<Loading what={title} lines={6} />}>
          <Page />
        </Suspense>
      </section>
    </div>
  );
}
