/** What a screen reader is told of the list: a table where there are columns, a list where there are cards. */
import { t } from "../text";

/** -1: the number is not known yet. */
const UNKNOWN = -1;

type Attributes = Record<string, string | number | undefined>;

export interface Roles {
  table: Attributes;
  body: Attributes;
  row: (index: number) => Attributes;
  cell: Attributes;
}

export function asTable(total: number | undefined): Roles {
  return {
    table: {
      role: "table",
      "aria-label": t("devices.title"),
      "aria-description": t("devices.keys"),
      "aria-rowcount": total === undefined ? UNKNOWN : total + 1,
    },
    body: { role: "rowgroup" },
    row: (index) => ({ role: "row", "aria-rowindex": index + 2 }),
    cell: { role: "cell" },
  };
}

export function asCards(total: number | undefined): Roles {
  return {
    table: {},
    body: { role: "list", "aria-label": t("devices.title"), "aria-description": t("devices.keys") },
    row: (index) => ({ role: "listitem", "aria-posinset": index + 1, "aria-setsize": total ?? UNKNOWN }),
    cell: {},
  };
}
