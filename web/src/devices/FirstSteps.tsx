import { Button } from "@mantine/core";
import { CarFront, KeyRound, Plus } from "lucide-react";
import { Copyable } from "../components/Copyable";
import { Trans, t } from "../text";
import css from "./first.module.css";
import { uploadCommand } from "./upload";

/** No device at all: what to do, in the order in which it is done. */
export function FirstSteps({ onAdd }: { onAdd: () => void }) {
  const command = uploadCommand(t("devices.first.your_id"), t("devices.first.your_key"), location.origin);
  return (
    <section className="card" aria-labelledby="first-steps">
      <h2 id="first-steps" className={css.title}>
        {t("devices.first.title")}
      </h2>
      <p>{t("devices.first.about")}</p>
      <ol className={css.steps}>
        <li>
          <Plus size={22} aria-hidden />
          <h3>{t("devices.first.register")}</h3>
          <p>{t("devices.first.register_about")}</p>
          <Button onClick={onAdd}>{t("devices.add")}</Button>
        </li>
        <li>
          <KeyRound size={22} aria-hidden />
          <h3>{t("devices.first.key")}</h3>
          <p>
            {/* biome-ignore lint/a11y/useAnchorContent: the sentence brings it */}
            <Trans i18nKey="devices.first.key_about" components={{ api: <a href="/docs" /> }} />
          </p>
          <Copyable label={t("devices.first.command")} text={command} />
        </li>
        <li>
          <CarFront size={22} aria-hidden />
          <h3>{t("devices.first.drive")}</h3>
          <p>{t("devices.first.drive_about")}</p>
        </li>
      </ol>
    </section>
  );
}
