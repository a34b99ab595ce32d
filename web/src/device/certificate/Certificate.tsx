import type { ReactNode } from "react";
import type { Device, Installation } from "../../api/types";
import { Logo } from "../../app/Logo";
import { QrCode } from "../../components/QrCode";
import { ClockTime, useNow } from "../../components/RelativeTime";
import { stageWord } from "../../lib/stages";
import { t } from "../../text";
import { shownMounting } from "../shown";
import css from "./certificate.module.css";
import { DriveTest } from "./DriveTest";
import { Mounting } from "./Mounting";

interface CertificateProps {
  name: string;
  device: Device | undefined;
  installation: Installation;
}

/** The installation on one printed page, for the vehicle's file. On the screen it is not shown. */
export default function Certificate({ name, device, installation }: CertificateProps) {
  const shown = shownMounting(installation);
  return (
    <article className={`${css.certificate} only-print`} data-mantine-color-scheme="light">
      <header>
        <h1>{t("device.certificate.title")}</h1>
        <span>
          <Logo size={22} /> Livella
        </span>
      </header>
      <div className={css.top}>
        <Facts name={name} device={device} installation={installation} />
        <Address id={installation.device_id} />
      </div>
      {shown ? <Mounting shown={shown} /> : <p>{t("device.certificate.nothing")}</p>}
      <DriveTest test={shown?.mount?.verification ?? null} />
      <footer>
        <span>{t("device.certificate.installer")}</span>
        <span>{t("device.certificate.signature")}</span>
      </footer>
    </article>
  );
}

function Facts({ name, device, installation }: CertificateProps) {
  const { device_id, stage, mount, last_data_at } = installation;
  const suspect = mount?.status === "suspect";
  return (
    <dl className={css.facts}>
      <Fact term={t("device.certificate.device")}>
        <span className={css.brief}>
          {name} ({device_id})
        </span>
      </Fact>
      <Fact term={t("device.certificate.vehicle")}>
        <span className={css.brief}>{device?.vehicle ?? t("common.unknown")}</span>
      </Fact>
      <Fact term={t("device.certificate.stage")}>
        {suspect ? t("device.certificate.suspect") : stageWord(stage)}
      </Fact>
      <Fact term={t("device.certificate.confirmed")}>
        {mount ? <ClockTime at={mount.confirmed_at} /> : t("device.certificate.not_yet")}
      </Fact>
      <Fact term={t("device.certificate.last_data")}>
        {last_data_at ? <ClockTime at={last_data_at} /> : t("common.unknown")}
      </Fact>
      <Fact term={t("device.certificate.printed")}>
        <Today />
      </Fact>
      {device?.notes && (
        <Fact term={t("device.certificate.notes")}>
          <span className={css.brief}>{device.notes}</span>
        </Fact>
      )}
    </dl>
  );
}

function Fact({ term, children }: { term: string; children: ReactNode }) {
  return (
    <div>
      <dt>{term}</dt>
      <dd>{children}</dd>
    </div>
  );
}

function Today() {
  return <ClockTime at={useNow().toISOString()} />;
}

/** Back from the paper to the page. */
function Address({ id }: { id: string }) {
  const address = `${location.origin}/devices/${encodeURIComponent(id)}`;
  return (
    <div className={css.address}>
      <QrCode text={address} label={t("device.certificate.page")} size={116} />
      <small>{address}</small>
    </div>
  );
}
