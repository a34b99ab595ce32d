import { Anchor } from "@mantine/core";
import { ArrowLeft, Printer, Route } from "lucide-react";
import { Link } from "wouter";
import { useMay } from "../../api/session";
import type { Device } from "../../api/types";
import { t } from "../../text";
import { HeadAction, HeadLink } from "./HeadAction";
import css from "./head.module.css";
import { MoreMenu } from "./MoreMenu";
import { RefitButton } from "./RefitButton";

interface PageHeadProps {
  name: string;
  id: string;
  /** unknown to a device's own key */
  device: Device | undefined;
}

export function PageHead({ name, id, device }: PageHeadProps) {
  const installer = useMay("installer");
  return (
    <header className={css.head}>
      {installer && (
        <Anchor component={Link} href="/devices" className={css.back}>
          <ArrowLeft size={18} aria-hidden /> {t("shell.devices")}
        </Anchor>
      )}
      <div className={css.title}>
        <h1>{name}</h1>
        <p className={css.facts}>
          {name !== id && <span>{id}</span>}
          {device?.vehicle && <span>{device.vehicle}</span>}
        </p>
      </div>
      <div className={css.actions}>
        <HeadLink
          icon={Route}
          label={t("device.action.motion")}
          to={`/devices/${encodeURIComponent(id)}/motion`}
        />
        <HeadAction icon={Printer} label={t("device.action.print")} onClick={() => window.print()} />
        {installer && <RefitButton id={id} />}
        {installer && device && <MoreMenu device={device} />}
      </div>
    </header>
  );
}
