import { describe, expect, it } from "vitest";
import { type AlertPage, beginning, following, matches, nextPage, shown, withChanged } from "./alertList";
import type { AlertFilter } from "./keys";
import type { Alert } from "./types";

const ALL: AlertFilter = { state: "all", kind: "", severity: "", deviceId: "", from: "", to: "" };

/** Opened in the order of their ids, a minute apart unless told otherwise. */
const alert = (id: number, over: Partial<Alert> = {}): Alert => ({
  id,
  device_id: "a",
  kind: "gps_lost",
  severity: "warning",
  state: "open",
  opened_at: new Date(Date.UTC(2025, 10, 22, 10, id)).toISOString(),
  updated_at: "2025-11-22T10:00:00Z",
  count: 1,
  message: "",
  data: {},
  acknowledged_at: null,
  acknowledged_by: null,
  acknowledge_note: null,
  resolved_at: null,
  resolved_by: null,
  resolve_note: null,
  ...over,
});

/** A service that has these lists, each newest first, and gives so many at a time. */
function service(lists: readonly (readonly number[])[], size: number) {
  const asked: number[] = [];
  const read = async (list: number, cursor: string | null) => {
    asked.push(list);
    const [all, from] = [lists[list] ?? [], Number(cursor ?? 0)];
    const next_cursor = from + size < all.length ? String(from + size) : null;
    return { items: all.slice(from, from + size).map((id) => alert(id)), next_cursor };
  };
  return { asked, read };
}

async function readAll(lists: readonly (readonly number[])[], size: number): Promise<number[][]> {
  const { read } = service(lists, size);
  const pages: AlertPage[] = [];
  let places: ReturnType<typeof following> = beginning(lists.length);
  while (places) {
    const page: AlertPage = await nextPage(places, read);
    pages.push(page);
    places = following(page);
  }
  return pages.map(({ items }) => items.map(({ id }) => id));
}

describe("two lists read as one", () => {
  const cases: [number[], number[], number][] = [
    [[9, 7, 5, 3, 1], [8, 6, 4, 2], 2],
    [[9, 8, 7, 6, 5, 4], [3, 2, 1], 2],
    [[3], [9, 8, 7, 6, 5, 4, 2, 1], 3],
    [[], [9, 8, 7], 2],
    [[], [], 2],
    [[9, 8, 7, 6], [], 500],
  ];
  it.each(cases)("gives %j and %j, %i at a time, all of them newest first", async (a, b, size) => {
    const pages = await readAll([a, b], size);
    expect(pages.flat()).toEqual([...a, ...b].sort((x, y) => y - x));
  });

  it("never gives an empty page in the middle, which would look like the end", async () => {
    const pages = await readAll(
      [
        [9, 8, 7, 6, 5, 4],
        [3, 2, 1],
      ],
      2,
    );
    expect(pages.slice(0, -1).every((page) => page.length > 0)).toBe(true);
  });

  it("reads on only where nothing waits", async () => {
    const { asked, read } = service(
      [
        [9, 8, 7, 6, 5, 4],
        [3, 2, 1],
      ],
      2,
    );
    const first = await nextPage(beginning(2), read);
    await nextPage(following(first) ?? [], read);
    expect(asked).toEqual([0, 1, 0]);
  });

  it("sorts those of one moment by their number, as the service does", async () => {
    const at = "2025-11-22T10:00:00Z";
    const read = async (list: number) => ({
      items: [alert(list + 1, { opened_at: at })],
      next_cursor: null,
    });
    const { items } = await nextPage(beginning(2), read);
    expect(items.map(({ id }) => id)).toEqual([2, 1]);
  });
});

describe("an alert that changed", () => {
  const page: AlertPage = {
    items: [alert(3)],
    places: [{ cursor: null, ended: true, waiting: [alert(2)] }],
  };
  const seen = (known: Alert): Alert => ({ ...known, state: "acknowledged" });

  it("changes where it is shown and where it waits", () => {
    expect(withChanged(page, 3, seen).items[0]?.state).toBe("acknowledged");
    expect(withChanged(page, 2, seen).places[0]?.waiting[0]?.state).toBe("acknowledged");
  });

  it("leaves the page as it is when it is not there", () => expect(withChanged(page, 9, seen)).toBe(page));

  it("is shown once though it is on two pages", () => {
    expect(shown([page, page]).map(({ id }) => id)).toEqual([3]);
  });
});

describe("whether a filter lets an alert through", () => {
  it.each<[Partial<AlertFilter>, Partial<Alert>, boolean]>([
    [{ state: "unresolved" }, { state: "open" }, true],
    [{ state: "unresolved" }, { state: "acknowledged" }, true],
    [{ state: "unresolved" }, { state: "resolved" }, false],
    [{ state: "open" }, { state: "acknowledged" }, false],
    [{ state: "all" }, { state: "resolved" }, true],
    [{ kind: "gps_lost" }, { kind: "clock_fault" }, false],
    [{ severity: "critical" }, { severity: "warning" }, false],
    [{ deviceId: "a" }, { device_id: "b" }, false],
    [{ deviceId: "a" }, { device_id: "a" }, true],
  ])("%j, %j: %s", (filter, over, through) => {
    expect(matches({ ...ALL, ...filter }, alert(1, over))).toBe(through);
  });

  it("takes whole days of the reader's calendar, the last one too", () => {
    const evening = alert(1, { opened_at: new Date(2025, 10, 22, 23, 59).toISOString() });
    const day = (from: string, to: string) => matches({ ...ALL, from, to }, evening);
    expect(day("2025-11-22", "2025-11-22")).toBe(true);
    expect(day("", "2025-11-21")).toBe(false);
    expect(day("2025-11-23", "")).toBe(false);
  });
});
