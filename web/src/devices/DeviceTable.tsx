import { useMediaQuery } from "@mantine/hooks";
import type { useDevices } from "../api/devices";
import type { Device, DeviceOrder } from "../api/types";
import { Failed } from "../components/States";
import { t } from "../text";
import { ColumnHeads } from "./ColumnHeads";
import { Coming, DeviceRow, type DeviceRowProps } from "./DeviceRow";
import { asCards, asTable } from "./roles";
import css from "./table.module.css";
import type { Change } from "./useFilter";
import { useReadAhead, useRows } from "./useRows";

interface DeviceTableProps {
  list: ReturnType<typeof useDevices>;
  rows: readonly Device[];
  /** undefined: not known yet */
  total: number | undefined;
  sort: DeviceOrder;
  onChange: Change;
}

/**
 * A table on a wide screen, a list of cards on a phone. However long it is, only what is on the screen is in the document;
 * a screen reader is told the true number and place of each row.
 */
export function DeviceTable({ list, rows, total, sort, onChange }: DeviceTableProps) {
  const isWide = useMediaQuery("(min-width: 62em)", false, { getInitialValueInEffect: false });
  const roles = isWide ? asTable(total) : asCards(total);
  const ahead = list.hasNextPage ? Math.max(total ?? 0, rows.length + 1) : rows.length;
  const { body, virtualizer, items, tabStop, handlers } = useRows(rows, ahead, isWide);
  const sortAnew: Change = (change) => {
    onChange(change);
    toTop(body.current?.parentElement);
  };
  const again = list.isFetchNextPageError ? list.fetchNextPage : list.refetch;
  useReadAhead(list, rows.length, items.at(-1)?.index ?? 0);
  return (
    <>
      <div
        className={css.table}
        {...roles.table}
        aria-busy={list.isPlaceholderData}
        data-stale={list.isPlaceholderData || undefined}
      >
        {isWide && <ColumnHeads sort={sort} onChange={sortAnew} />}
        <div
          ref={body}
          className={css.body}
          {...roles.body}
          {...handlers}
          style={{ height: virtualizer.getTotalSize() }}
        >
          {items.map(({ index, start }) => (
            <div
              key={rows[index]?.id ?? index}
              ref={isWide ? undefined : virtualizer.measureElement}
              className={css.place}
              data-index={index}
              {...roles.row(index)}
              style={{ transform: `translateY(${start - virtualizer.options.scrollMargin}px)` }}
            >
              <Row device={rows[index]} cell={roles.cell} isTabStop={index === tabStop} />
            </div>
          ))}
        </div>
      </div>
      {list.isError && (
        <div className={css.trouble}>
          <Failed what={t("devices.the_devices")} error={list.error} retry={again} />
        </div>
      )}
    </>
  );
}

/** In another order the place in the list means nothing: begin at its top, when that was scrolled away. */
function toTop(table: Element | null | undefined): void {
  if (table && table.getBoundingClientRect().top < 0) table.scrollIntoView();
}

/** A row that has not been read yet is known to come. */
function Row({ device, ...rest }: Omit<DeviceRowProps, "device"> & { device: Device | undefined }) {
  return device ? <DeviceRow device={device} {...rest} /> : <Coming cell={rest.cell} />;
}
