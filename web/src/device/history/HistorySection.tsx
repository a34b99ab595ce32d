import { Button, SegmentedControl } from "@mantine/core";
import { ChartLine, ZoomOut } from "lucide-react";
import { useMemo, useState } from "react";
import type { TimeRange } from "../../api/keys";
import { useEstimates } from "../../api/queries";
import { Section } from "../../components/Section";
import { Empty, Failed, Loading } from "../../components/States";
import { AngleChart } from "./AngleChart";
import { ANGLES, angleHistory, RANGES, type Range, rangeStart } from "./history";
import css from "./history.module.css";

interface HistoryProps {
  id: string;
  lastData: string | null;
}

/** How the angles came about: three charts with one time axis. */
export function HistorySection({ id, lastData }: HistoryProps) {
  const [range, setRange] = useState<Range>("Hour");
  const [zoomed, setZoomed] = useState<TimeRange | null>(null);
  const window = zoomed ?? { from: rangeStart(range, lastData), to: null };
  const zoom = (from: number, to: number) => setZoomed({ from: moment(from), to: moment(to) });
  const controls = (
    <div className={css.controls}>
      {zoomed && (
        <Button
          size="sm"
          variant="light"
          leftSection={<ZoomOut size={18} aria-hidden />}
          onClick={() => setZoomed(null)}
        >
          Reset zoom
        </Button>
      )}
      <SegmentedControl
        aria-label="Time span"
        data={[...RANGES]}
        value={range}
        onChange={(value) => {
          setRange(value as Range);
          setZoomed(null);
        }}
      />
    </div>
  );
  return (
    <Section title="Angle history" aside={controls} className="no-print">
      <Charts id={id} window={window} onZoom={zoom} />
    </Section>
  );
}

function moment(seconds: number): string {
  return new Date(seconds * 1000).toISOString();
}

function Charts({
  id,
  window,
  onZoom,
}: {
  id: string;
  window: TimeRange;
  onZoom: (from: number, to: number) => void;
}) {
  const estimates = useEstimates(id, window);
  const history = useMemo(() => estimates.data && angleHistory(estimates.data), [estimates.data]);
  if (estimates.isError)
    return <Failed what="the history" error={estimates.error} retry={estimates.refetch} />;
  if (!history) return <Loading what="the history" lines={6} />;
  if (history.time.length === 0) {
    return (
      <Empty icon={ChartLine} title={window.to ? "No angles in this span" : "No angles yet"}>
        The curve begins with the first estimate.
      </Empty>
    );
  }
  return (
    <div className={css.charts}>
      {ANGLES.map((angle) => (
        <AngleChart
          key={angle}
          angle={angle}
          history={history}
          onZoom={onZoom}
          lowest={angle === ANGLES.at(-1)}
        />
      ))}
      <p className={css.note}>
        The band is one standard deviation. Drag across a chart to zoom. Near a pitch of ±90° roll and yaw are
        not unique.
      </p>
    </div>
  );
}
