import { ActionIcon, Button, useComputedColorScheme, useMantineColorScheme } from "@mantine/core";
import {
  CircleUserRound,
  LogOut,
  type LucideIcon,
  Moon,
  Settings,
  Sun,
  TriangleAlert,
  Truck,
} from "lucide-react";
import type { ReactNode } from "react";
import { Link, useRoute } from "wouter";
import { useSummary } from "../api/queries";
import { atLeast, useSignOut } from "../api/session";
import type { Role, SignedIn } from "../api/types";
import { Said } from "../components/Said";
import { Trouble } from "../components/States";
import { whole } from "../lib/format";
import { t } from "../text";
import { LanguageSwitch } from "./LanguageSwitch";
import { LiveLamp } from "./Live";
import { Logo } from "./Logo";
import css from "./shell.module.css";

/** The frame of every page: where one is, whether it is live, who one is. */
export function Shell({ session, children }: { session: SignedIn; children: ReactNode }) {
  return (
    <>
      <a className={css.skip} href="#main">
        {t("shell.skip")}
      </a>
      <header className={`${css.bar} no-print`}>
        <div className={css.inner}>
          <Link href="/" className={css.brand} aria-label={t("shell.home")}>
            <Logo />
            <span>Livella</span>
          </Link>
          <LiveLamp />
          <div className={css.tools}>
            <SchemeButton />
            <AccountMenu session={session} />
          </div>
        </div>
        {session.device_id === null && <Places role={session.role} />}
      </header>
      <main id="main" className={css.main} tabIndex={-1}>
        {children}
      </main>
      <Said />
    </>
  );
}

/** Where one can go; a device's key has one place only. */
function Places({ role }: { role: Role }) {
  const summary = useSummary();
  return (
    <nav className={css.places} aria-label={t("shell.places")}>
      <Place to="/devices" icon={Truck} word={t("shell.devices")} />
      {atLeast(role, "manager") && (
        <Place to="/alerts" icon={TriangleAlert} word={t("shell.alerts")} count={summary.data?.open_alerts} />
      )}
      <Place to="/settings" icon={Settings} word={t("shell.settings")} />
    </nav>
  );
}

interface PlaceProps {
  to: string;
  icon: LucideIcon;
  word: string;
  count?: number | undefined;
}

function Place({ to, icon: Icon, word, count }: PlaceProps) {
  const [here] = useRoute(`${to}/*?`);
  return (
    <Link href={to} className={css.place} aria-current={here ? "page" : undefined}>
      <Icon size={18} aria-hidden />
      {word}
      {count !== undefined && count > 0 && <b>{whole(count)}</b>}
    </Link>
  );
}

function SchemeButton() {
  const { setColorScheme } = useMantineColorScheme({ keepTransitions: true });
  const scheme = useComputedColorScheme("light");
  const other = scheme === "dark" ? "light" : "dark";
  return (
    <ActionIcon
      onClick={() => setColorScheme(other)}
      aria-label={t(other === "dark" ? "shell.to_dark" : "shell.to_light")}
      color="gray"
    >
      {scheme === "dark" ? <Sun size={20} aria-hidden /> : <Moon size={20} aria-hidden />}
    </ActionIcon>
  );
}

const ACCOUNT = "account";

/** The browser's own popover: it closes on Escape and on a click elsewhere, and costs nothing to load. */
function AccountMenu({ session }: { session: SignedIn }) {
  const signOut = useSignOut();
  return (
    <>
      <ActionIcon
        aria-label={t("shell.account", { name: session.name })}
        color="gray"
        popoverTarget={ACCOUNT}
      >
        <CircleUserRound size={22} aria-hidden />
      </ActionIcon>
      <div id={ACCOUNT} popover="auto" className={css.account}>
        <p>
          <b>{session.name}</b>
          <br />
          {t(`shell.role.${session.role}`)}
        </p>
        <LanguageSwitch />
        {signOut.error && <Trouble title={t("shell.not_signed_out")} error={signOut.error} />}
        <Button
          variant="default"
          fullWidth
          leftSection={<LogOut size={18} aria-hidden />}
          loading={signOut.isPending}
          onClick={() => signOut.mutate()}
        >
          {t("shell.sign_out")}
        </Button>
      </div>
    </>
  );
}
