import { ActionIcon, Menu, useComputedColorScheme, useMantineColorScheme } from "@mantine/core";
import { CircleUserRound, LogOut, Moon, Sun } from "lucide-react";
import type { ReactNode } from "react";
import { Link } from "wouter";
import { useSignOut } from "../api/session";
import type { Role, SignedIn } from "../api/types";
import { LiveLamp } from "./Live";
import { Logo } from "./Logo";
import css from "./shell.module.css";

const ROLE: Record<Role, string> = {
  device: "Device",
  installer: "Installer",
  manager: "Fleet manager",
  admin: "Administrator",
};

/** The frame of every page: where one is, whether it is live, who one is. */
export function Shell({ session, children }: { session: SignedIn; children: ReactNode }) {
  return (
    <>
      <a className={css.skip} href="#main">
        Skip to the content
      </a>
      <header className={`${css.bar} no-print`}>
        <div className={css.inner}>
          <Link href="/" className={css.brand} aria-label="Livella, home">
            <Logo />
            <span>Livella</span>
          </Link>
          <LiveLamp />
          <div className={css.tools}>
            <SchemeButton />
            <AccountMenu session={session} />
          </div>
        </div>
      </header>
      <main id="main" className={css.main} tabIndex={-1}>
        {children}
      </main>
    </>
  );
}

function SchemeButton() {
  const { setColorScheme } = useMantineColorScheme({ keepTransitions: true });
  const scheme = useComputedColorScheme("light");
  const other = scheme === "dark" ? "light" : "dark";
  return (
    <ActionIcon
      onClick={() => setColorScheme(other)}
      aria-label={`Switch to the ${other} colours`}
      color="gray"
    >
      {scheme === "dark" ? <Sun size={20} aria-hidden /> : <Moon size={20} aria-hidden />}
    </ActionIcon>
  );
}

function AccountMenu({ session }: { session: SignedIn }) {
  const signOut = useSignOut();
  return (
    <Menu position="bottom-end" width={220} withinPortal={false}>
      <Menu.Target>
        <ActionIcon aria-label={`Account: ${session.name}`} color="gray">
          <CircleUserRound size={22} aria-hidden />
        </ActionIcon>
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Label>
          {session.name}
          <br />
          {ROLE[session.role]}
        </Menu.Label>
        <Menu.Item leftSection={<LogOut size={18} aria-hidden />} onClick={() => signOut.mutate()}>
          Sign out
        </Menu.Item>
      </Menu.Dropdown>
    </Menu>
  );
}
