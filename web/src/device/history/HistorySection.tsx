import { SegmentedControl } from "@mantine/core";
import { ChartLine } from "lucide-react";
import { useMemo, useRef } from "react";
import { useEstimates } from "../../api/history";
import { useMounts } from "../../api/mounts";
import { useDeviceAlerts } from "../../api/queries";
import { useMay } from "../../api/session";
import type { Estimates } from "../../api/types";
import { Section } from "../../components/Section";
import { Empty, Failed, Loading } from "../../components/States";
import { between } from "../../lib/time";
import { t } from "../../text";
import { Charts } from "./Charts";
import { Events } from "./Events";
import { angleHistory, extentOf } from "./history";
import css from "./history.module.css";
import { type Mark, marksOf } from "./marks";
import { RANGES, type Range } from "./span";
import { Toolbar } from "./Toolbar";
import { type HistoryWindow, useLimits, useWindow } from "./useWindow";

interface HistoryProps {
  id: string;
  lastData: string | null;
}

/** How the angles came about: three charts with one time axis, and what happened meanwhile. */
export default function HistorySection({ id, lastData }: HistoryProps) {
  const window = useWindow(lastData);
  return (
    <Section
      title={t("history.title")}
      aside={<Ranges chosen={window.range} choose={window.choose} />}
      className="no-print"
    >
      <History id={id} window={window} />
    </Section>
  );
}

function Ranges({ chosen, choose }: { chosen: Range; choose: (range: Range) => void }) {
  const data = RANGES.map((value) => ({
    value,
    label: (
      <>
        <span aria-hidden>{t(`history.${value}.short`)}</span>
        <span className="visually-hidden">{t(`history.${value}.long`)}</span>
      </>
    ),
  }));
  return <SegmentedControl aria-label={t("history.range")} data={data} value={chosen} onChange={choose} />;
}

function History({ id, window }: { id: string; window: HistoryWindow }) {
  const estimates = useEstimates(id, window.wanted);
  const known = useLast(estimates.data);
  const what = t("history.the_history");
  const failed = estimates.isError && (
    <Failed what={what} error={estimates.error} retry={estimates.refetch} />
  );
  if (!known) return failed || <Loading what={what} lines={12} />;
  if (known.time.length === 0 && window.view === null) {
    return (
      <Empty icon={ChartLine} title={t("history.no_angles")}>
        {t("history.begins")}
      </Empty>
    );
  }
  return (
    <>
      {failed}
      <Loaded id={id} window={window} estimates={known} />
    </>
  );
}

/** What was loaded last: who moves to where nothing can be loaded must be able to move back. */
function useLast(estimates: Estimates | undefined): Estimates | undefined {
  const last = useRef(estimates);
  if (estimates) last.current = estimates;
  return last.current;
}

function Loaded({ id, window, estimates }: { id: string; window: HistoryWindow; estimates: Estimates }) {
  const history = useMemo(() => angleHistory(estimates), [estimates]);
  const marks = useMarks(id, estimates);
  const extent = useMemo(() => extentOf(history), [history]);
  const shown = window.view ?? extent;
  useLimits(id, window, extent);
  return (
    <div className={css.all}>
      <Toolbar id={id} window={window} />
      {shown && (
        <p role="status" className={css.shown}>
          {between(new Date(shown.min * 1000), new Date(shown.max * 1000))}
        </p>
      )}
      <Charts history={history} marks={marks} window={window} points={estimates.time.length} />
      <Events marks={marks} span={shown} time={window.time} />
    </div>
  );
}

function useMarks(id: string, estimates: Estimates): Mark[] {
  const mounts = useMounts(id).data;
  const alerts = useDeviceAlerts(id, useMay("manager")).data;
  return useMemo(
    () =>
      marksOf({
        estimates,
        mounts: mounts?.pages.flatMap(({ items }) => items) ?? [],
        alerts: alerts?.items ?? [],
      }),
    [estimates, mounts, alerts],
  );
}
