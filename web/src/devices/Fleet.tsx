import { NativeSelect } from "@mantine/core";
import { ArrowUpDown } from "lucide-react";
import { useMemo } from "react";
import { rowsOf, useDevices } from "../api/devices";
import type { DeviceFilter } from "../api/keys";
import type { FleetSummary } from "../api/types";
import { Failed, Loading } from "../components/States";
import { whole } from "../lib/format";
import { t } from "../text";
import { DeviceTable } from "./DeviceTable";
import css from "./devices.module.css";
import { expected, ORDERS } from "./filter";
import { NothingFound } from "./NothingFound";
import { SearchBox } from "./SearchBox";
import type { Change } from "./useFilter";

interface FleetProps {
  filter: DeviceFilter;
  onChange: Change;
  summary: FleetSummary | undefined;
}

/** The devices that the filter lets through. */
export function Fleet({ filter, onChange, summary }: FleetProps) {
  const list = useDevices({ ...filter, q: filter.q.trim() });
  const pages = list.data?.pages;
  const rows = useMemo(() => rowsOf(pages ?? []), [pages]);
  const total = list.hasNextPage ? expected(filter, summary) : pages && rows.length;
  return (
    <>
      <div className={css.tools}>
        <SearchBox value={filter.q} onChange={(q) => onChange({ q }, { replace: true })} />
        <Order {...{ filter, onChange }} />
        <p role="status">{pages && found(total, rows.length)}</p>
      </div>
      {results()}
    </>
  );

  function results() {
    const what = t("devices.the_devices");
    if (list.isPending) return <Loading what={what} lines={8} />;
    if (!pages) return <Failed what={what} error={list.error as Error} retry={list.refetch} />;
    if (rows.length === 0) return <NothingFound filter={filter} onChange={onChange} />;
    return <DeviceTable list={list} rows={rows} total={total} sort={filter.sort} onChange={onChange} />;
  }
}

/** Columns have heads to press on a wide screen only. */
function Order({ filter, onChange }: Pick<FleetProps, "filter" | "onChange">) {
  return (
    <NativeSelect
      className={css.order}
      size="md"
      aria-label={t("devices.sort")}
      leftSection={<ArrowUpDown size={18} aria-hidden />}
      data={ORDERS.map((value) => ({ value, label: t(`devices.order.${value}`) }))}
      value={filter.sort}
      onChange={({ currentTarget }) => onChange({ sort: currentTarget.value as DeviceFilter["sort"] })}
    />
  );
}

/** `total` is not known while a search goes on below what was read. */
function found(total: number | undefined, read: number): string {
  if (total === undefined) return t("devices.found_more", { shown: whole(read) });
  return t("devices.found", { count: total, shown: whole(total) });
}
