import { Suspense } from "react";
import { Problem } from "../api/http";
import { useDevice, useInstallation } from "../api/queries";
import { useMay } from "../api/session";
import type { Device, Installation } from "../api/types";
import { NotFound } from "../app/NotFound";
import { useTitle } from "../app/title";
import { optional } from "../components/optional";
import { Failed, Loading } from "../components/States";
import { t } from "../text";
import { AlertsSection } from "./AlertsSection";
import css from "./device.module.css";
import { MountingSection } from "./done/MountingSection";
import { NumbersSection } from "./done/NumbersSection";
import { PageHead } from "./head/PageHead";
import { LiveCard } from "./live/LiveCard";
import { MountsSection } from "./MountsSection";
import { Past } from "./Past";
import { shownMounting } from "./shown";
import { UncertaintySection } from "./uncertainty/UncertaintySection";
import { VerificationSection } from "./verification/VerificationSection";

/** It is for paper: it may come after what is seen. */
const Certificate = optional(() => import("./certificate/Certificate"));

/** One device: is it talking, what is missing, is it done, how is it mounted, and why. */
export function DevicePage({ id }: { id: string }) {
  const listed = useMay("installer");
  const device = useDevice(id, listed);
  const installation = useInstallation(id);
  const name = device.data?.name ?? id;
  useTitle(name);
  if (installation.error instanceof Problem && [403, 404].includes(installation.error.status)) {
    return <NotFound title={t("device.gone", { id })} />;
  }
  const what = t("device.the_device");
  if (installation.isPending || (listed && device.isPending)) return <Loading what={what} lines={8} />;
  if (installation.isError) {
    return <Failed what={what} error={installation.error} retry={installation.refetch} />;
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
  const verification = <VerificationSection installation={installation} />;
  const now = installation.stage === "verifying";
  return (
    <>
      <div className={`${css.page} no-print`}>
        <PageHead name={name} id={id} device={device} />
        <LiveCard installation={installation} />
        {now && verification}
        <div className={css.columns}>
          <div className={css.side}>
            <MountingSection shown={shown} />
            {shown && <NumbersSection shown={shown} />}
          </div>
          <div className={css.side}>
            {!now && verification}
            <UncertaintySection installation={installation} />
            <MountsSection id={id} />
          </div>
        </div>
        <AlertsSection id={id} open={installation.open_alerts} />
        <Past id={id} lastData={installation.last_data_at} />
      </div>
      <Suspense fallback={null}>
        <Certificate name={name} device={device} installation={installation} />
      </Suspense>
    </>
  );
}
