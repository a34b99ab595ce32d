import { ArrowDown, ArrowUp, ChevronsUpDown } from "lucide-react";
import type { DeviceOrder } from "../api/types";
import { t } from "../text";
import { type Column, direction, pressed } from "./filter";
import css from "./table.module.css";
import type { Change } from "./useFilter";

const COLUMNS = ["name", "id", "vehicle", "stage", "last_data_at", "alerts"] as const;
const ICON = { ascending: ArrowUp, descending: ArrowDown, none: ChevronsUpDown };

interface ColumnHeadsProps {
  sort: DeviceOrder;
  onChange: Change;
}

export function ColumnHeads({ sort, onChange }: ColumnHeadsProps) {
  return (
    <div {...{ role: "rowgroup" }} className={css.heads}>
      <div {...{ role: "row", "aria-rowindex": 1 }} className={css.columns}>
        {COLUMNS.map((column) =>
          isSortable(column) ? (
            <div key={column} {...{ role: "columnheader", "aria-sort": direction(sort, column) }}>
              <SortButton {...{ column, sort, onChange }} />
            </div>
          ) : (
            <div key={column} {...{ role: "columnheader" }}>
              {t(`devices.column.${column}`)}
            </div>
          ),
        )}
      </div>
    </div>
  );
}

function isSortable(column: (typeof COLUMNS)[number]): column is Column {
  return column === "name" || column === "id" || column === "last_data_at";
}

function SortButton({ column, sort, onChange }: ColumnHeadsProps & { column: Column }) {
  const Icon = ICON[direction(sort, column)];
  return (
    <button type="button" className={css.sort} onClick={() => onChange({ sort: pressed(sort, column) })}>
      {t(`devices.column.${column}`)}
      <Icon size={16} aria-hidden />
    </button>
  );
}
