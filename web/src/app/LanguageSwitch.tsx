import { SegmentedControl } from "@mantine/core";
import { chooseLanguage, LANGUAGES, type Language, language, t } from "../text";

const CHOICES = Object.entries(LANGUAGES).map(([value, label]) => ({ value, label }));

export function LanguageSwitch() {
  return (
    <SegmentedControl
      aria-label={t("shell.language")}
      fullWidth
      data={CHOICES}
      value={language()}
      onChange={(chosen) => chooseLanguage(chosen as Language)}
    />
  );
}
