import { Anchor, SegmentedControl, useMantineColorScheme } from "@mantine/core";
import type { ReactNode } from "react";
import { useVersion } from "../api/service";
import { LanguageSwitch } from "../app/LanguageSwitch";
import { Section } from "../components/Section";
import { Failed, Loading } from "../components/States";
import { Trans, t } from "../text";
import css from "./settings.module.css";

/** What this is, and how it looks on this browser. */
export function AboutPage() {
  return (
    <>
      <Section title={t("settings.about.service")}>
        <Version />
        <p>
          <Trans
            i18nKey="settings.about.api"
            components={{ a: <Anchor href="/docs" target="_blank" underline="always" /> }}
          />
        </p>
      </Section>
      <Section title={t("settings.about.reader")}>
        <div className={css.choices}>
          <Labelled label={t("settings.about.language")}>
            <LanguageSwitch />
          </Labelled>
          <Labelled label={t("settings.about.colours")}>
            <Colours />
          </Labelled>
        </div>
      </Section>
      <Section title={t("settings.about.stores")}>
        <ul>
          {(["cookie", "choices", "seen", "nothing_else"] as const).map((what) => (
            <li key={what}>{t(`settings.about.stores_${what}`)}</li>
          ))}
        </ul>
      </Section>
    </>
  );
}

function Labelled({ label, children }: { label: string; children: ReactNode }) {
  return (
    <div>
      <p className={css.label}>{label}</p>
      {children}
    </div>
  );
}

function Version() {
  const version = useVersion();
  if (version.isPending) return <Loading what={t("settings.about.the_version")} lines={1} />;
  if (version.isError)
    return <Failed what={t("settings.about.the_version")} error={version.error} retry={version.refetch} />;
  return (
    <p>
      {t("settings.about.version")} <b>{version.data}</b>
    </p>
  );
}

const SCHEMES = ["auto", "light", "dark"] as const;

function Colours() {
  const { colorScheme, setColorScheme } = useMantineColorScheme({ keepTransitions: true });
  return (
    <SegmentedControl
      aria-label={t("settings.about.colours")}
      fullWidth
      data={SCHEMES.map((value) => ({ value, label: t(`settings.about.${value}`) }))}
      value={colorScheme}
      onChange={(value) => setColorScheme(value)}
    />
  );
}
