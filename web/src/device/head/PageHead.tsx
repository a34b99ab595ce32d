import { Anchor } from "@mantine/core";
import { ArrowLeft, Printer } from "lucide-react";
import { Link } from "wouter";
import { useMay } from "../../api/session";
import type { Device, Installation } from "../../api/types";
import { RelativeTime } from "../../components/RelativeTime";
import { Trans, t } from "../../text";
import { HeadAction } from "./HeadAction";
import css from "./head.module.css";
import { MoreMenu } from "./MoreMenu";
import { RefitButton } from "./RefitButton";

interface PageHeadProps {
  name: string;
  /** unknown to a device's own key */
  device: Device | undefined;
  installation: Installation;
}

export function PageHead({ name, device, installation }: PageHeadProps) {
  const installer = useMay("installer");
  const id = installation.device_id;
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
          <span>
            <LastData at={installation.last_data_at} />
          </span>
        </p>
      </div>
      <div className={css.actions}>
        <HeadAction icon={Printer} label={t("device.action.print")} onClick={() => window.print()} />
        {installer && <RefitButton id={id} />}
        {installer && device && <MoreMenu device={device} />}
      </div>
    </header>
  );
}

function LastData({ at }: { at: string | null }) {
  if (at === null) return t("device.no_data_yet");
  return <Trans i18nKey="device.last_data" components={{ ago: <RelativeTime at={at} /> }} />;
}
