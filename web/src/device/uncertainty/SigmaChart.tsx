import { Suspense, useMemo } from "react";
import { useEstimates } from "../../api/history";
import type { Installation } from "../../api/types";
import { optional } from "../../components/optional";
import { Failed, Loading } from "../../components/States";
import { t } from "../../text";
import { calibrationRange, sigmaHistory } from "./sigma";

/** Estimates asked for: about one for every two pixels of the chart. */
const POINTS = 200;

const SigmaLines = optional(() => import("./SigmaLines"));

/** How the three sigmas shrank. The chart comes when there is something to draw. */
export function SigmaChart({ installation }: { installation: Installation }) {
  const { device_id, limits } = installation;
  const estimates = useEstimates(device_id, { range: calibrationRange(installation), points: POINTS });
  const history = useMemo(() => estimates.data && sigmaHistory(estimates.data), [estimates.data]);
  if (estimates.isError)
    return <Failed what={t("device.sure.the_chart")} error={estimates.error} retry={estimates.refetch} />;
  if (!history) return <Loading what={t("device.sure.the_chart")} />;
  if (history.time.length < 2) return null;
  return (
    <Suspense fallback={<Loading what={t("device.sure.the_chart")} />}>
      <SigmaLines history={history} limits={limits} />
    </Suspense>
  );
}
