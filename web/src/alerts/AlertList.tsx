import { Button } from "@mantine/core";
import { useInViewport } from "@mantine/hooks";
import { useEffect, useState } from "react";
import { useAlerts, type Verb } from "../api/alerts";
import type { AlertFilter } from "../api/keys";
import type { Alert } from "../api/types";
import { Failed, Loading } from "../components/States";
import { t } from "../text";
import { AlertCard } from "./AlertCard";
import css from "./alerts.module.css";
import { NoAlerts } from "./NoAlerts";
import { SelectAll, SelectionBar } from "./Selection";
import { SettleDialog } from "./SettleDialog";
import { isDue } from "./settling";

interface AlertListProps {
  filter: AlertFilter;
  onClear: () => void;
}

/** Newest first, read on as one comes down to the end. */
export function AlertList({ filter, onClear }: AlertListProps) {
  const list = useAlerts(filter);
  const [settling, setSettling] = useState<{ alerts: readonly Alert[]; verb: Verb } | null>(null);
  if (list.isPending) return <Loading what={t("alerts.the_alerts")} lines={8} />;
  if (list.isError) return <Failed what={t("alerts.the_alerts")} error={list.error} retry={list.refetch} />;
  return (
    <>
      {list.data.length === 0 && <NoAlerts filter={filter} onClear={onClear} />}
      <Alerts
        alerts={list.data}
        busy={list.isPlaceholderData}
        onSettle={(alerts, verb) => setSettling({ alerts, verb })}
      />
      {list.hasNextPage && <More pending={list.isFetchingNextPage} onMore={list.fetchNextPage} />}
      {settling && <SettleDialog {...settling} onClose={() => setSettling(null)} />}
    </>
  );
}

interface AlertsProps {
  alerts: readonly Alert[];
  busy: boolean;
  onSettle: (alerts: readonly Alert[], verb: Verb) => void;
}

/** Those that are not resolved can be selected, to be dealt with together. */
function Alerts({ alerts, busy, onSettle }: AlertsProps) {
  const [selected, setSelected] = useState<ReadonlySet<number>>(new Set());
  const selectable = alerts.filter((alert) => isDue(alert, "resolve"));
  const chosen = selectable.filter(({ id }) => selected.has(id));
  const selection = (id: number) => ({
    selected: selected.has(id),
    onChange: (on: boolean) => setSelected((before) => toggled(before, id, on)),
  });
  return (
    <>
      {selectable.length > 1 && <SelectAll of={selectable} chosen={chosen} onChange={setSelected} />}
      <ul className={css.list} aria-label={t("alerts.list")} aria-busy={busy}>
        {alerts.map((alert) => (
          <li key={alert.id}>
            <AlertCard alert={alert} showDevice selection={selection(alert.id)} />
          </li>
        ))}
      </ul>
      {chosen.length > 0 && <SelectionBar chosen={chosen} onChange={setSelected} onSettle={onSettle} />}
    </>
  );
}

function toggled(before: ReadonlySet<number>, id: number, on: boolean): ReadonlySet<number> {
  return new Set(on ? [...before, id] : [...before].filter((other) => other !== id));
}

/** Reads on by itself when one has come down to it; the button is for those who do not scroll. */
function More({ pending, onMore }: { pending: boolean; onMore: () => void }) {
  const { ref, inViewport } = useInViewport<HTMLDivElement>();
  useEffect(() => {
    if (inViewport && !pending) onMore();
  }, [inViewport, pending, onMore]);
  return (
    <div ref={ref} className={css.showMore}>
      <Button variant="default" loading={pending} onClick={onMore}>
        {t("alerts.show_more")}
      </Button>
    </div>
  );
}
