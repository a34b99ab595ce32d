import { useDocumentTitle } from "@mantine/hooks";
import { Problem } from "../api/http";
import { useDevice, useInstallation } from "../api/queries";
import { useMay } from "../api/session";
import type { Device, Installation } from "../api/types";
import { NotFound } from "../app/NotFound";
import { Failed, Loading } from "../components/States";
import { AlertsSection } from "./AlertsSection";
import css from "./device.module.css";
import { HistorySection } from "./history/HistorySection";
import { MountingSection } from "./MountingSection";
import { MountsSection } from "./MountsSection";
import { NumbersSection } from "./NumbersSection";
import { PageHead } from "./PageHead";
import { Record } from "./Record";
import { StageSection } from "./StageSection";
import { shownMounting } from "./shown";
import { UncertaintySection } from "./UncertaintySection";
import { VerificationSection } from "./VerificationSection";

/** One device: is it talking, what is missing, is it done, how is it mounted, and why. */
export function DevicePage({ id }: { id: string }) {
  const listed = useMay("installer");
  const device = useDevice(id, listed);
  const installation = useInstallation(id);
  const name = device.data?.name ?? id;
  useDocumentTitle(`${name} · Livella`);
  if (installation.error instanceof Problem && [403, 404].includes(installation.error.status)) {
    return <NotFound title={`The device ${id} does not exist`} />;
  }
  if (installation.isPending || (listed && device.isPending)) return <Loading what="the device" lines={8} />;
  if (installation.isError) {
    return <Failed what="the device" error={installation.error} retry={installation.refetch} />;
  }
  return <Content name={name} device={device.data} installation={installation.data} />;
}

interface ContentProps {
  name: string;
  device: Device | undefined;
  installation: Installation;
}

function Content({ name, device, installation }: ContentProps) {
  const shown = shownMounting(installation);
  const id = installation.device_id;
  return (
    <>
      <div className={`${css.page} no-print`}>
        <PageHead name={name} vehicle={device?.vehicle ?? null} installation={installation} />
        <StageSection installation={installation} />
        <div className={css.columns}>
          <MountingSection shown={shown} />
          <div className={css.side}>
            <VerificationSection verification={installation.verification} stage={installation.stage} />
            <UncertaintySection shown={shown} limits={installation.limits} />
            <MountsSection id={id} />
          </div>
        </div>
        <HistorySection id={id} lastData={installation.last_data_at} />
        <div className={css.halves}>
          <AlertsSection id={id} open={installation.open_alerts} />
          {shown && <NumbersSection shown={shown} />}
        </div>
      </div>
      <Record name={name} device={device} installation={installation} />
    </>
  );
}
