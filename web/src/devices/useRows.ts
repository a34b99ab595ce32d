import {
  defaultKeyExtractor,
  defaultRangeExtractor,
  type Range,
  useWindowVirtualizer,
} from "@tanstack/react-virtual";
import {
  type FocusEvent,
  type KeyboardEvent,
  type RefObject,
  useCallback,
  useEffect,
  useLayoutEffect,
  useMemo,
  useRef,
  useState,
} from "react";
import type { useDevices } from "../api/devices";
import type { Device } from "../api/types";

/** rem; of a row as in table.module.css, of a card before it has been measured */
const HEIGHT = { row: 3.5, card: 10.75 };
/** rows kept ready above and below the screen */
const OVERSCAN = 8;
/** rows to be there before one scrolls to them */
const AHEAD = 400;

/** The rows on the screen out of all of them, and the keys that go from one to the other. */
export function useRows(rows: readonly Device[], count: number, isWide: boolean) {
  const body = useRef<HTMLDivElement>(null);
  const [focused, setFocused] = useState<number | null>(null);
  /** Heights are remembered by device; those of rows are all the same. */
  const keyOf = useCallback((index: number) => rows[index]?.id ?? index, [rows]);
  /** The row with the focus stays in the document when it is scrolled away, or the focus would be lost. */
  const withFocused = useCallback(
    (range: Range) => {
      const shown = defaultRangeExtractor(range);
      if (focused === null || focused >= range.count || shown.includes(focused)) return shown;
      return [...shown, focused].sort((a, b) => a - b);
    },
    [focused],
  );
  const height = useMemo(() => (isWide ? HEIGHT.row : HEIGHT.card) * rem(), [isWide]);
  const virtualizer = useWindowVirtualizer({
    count,
    estimateSize: () => height,
    overscan: OVERSCAN,
    scrollMargin: useTop(body),
    getItemKey: isWide ? defaultKeyExtractor : keyOf,
    rangeExtractor: withFocused,
  });
  const goTo = useGoTo(body, (index) => virtualizer.scrollToIndex(index, { align: "center" }));
  const first = virtualizer.range?.startIndex ?? 0;
  const screenful = Math.max(1, (virtualizer.range?.endIndex ?? 1) - first - 2);
  const handlers = {
    onFocus: (event: FocusEvent) => setFocused(indexOf(event.target)),
    onBlur: () => {
      setFocused(null);
      goTo.cancel();
    },
    onKeyDown: (event: KeyboardEvent) => {
      const from = indexOf(event.target);
      const step = stepOf(event, screenful);
      if (from === null || step === null) return;
      event.preventDefault();
      goTo.go(Math.min(Math.max(from + step, 0), count - 1));
    },
  };
  return { body, virtualizer, items: virtualizer.getVirtualItems(), tabStop: focused ?? first, handlers };
}

function rem(): number {
  return Number.parseFloat(getComputedStyle(document.documentElement).fontSize);
}

function indexOf(target: EventTarget): number | null {
  const row = target instanceof Element ? target.closest<HTMLElement>("[data-index]") : null;
  return row ? Number(row.dataset.index) : null;
}

function stepOf(event: KeyboardEvent, screenful: number): number | null {
  if (event.ctrlKey || event.altKey || event.metaKey || event.shiftKey) return null;
  const steps: Record<string, number> = {
    ArrowDown: 1,
    ArrowUp: -1,
    PageDown: screenful,
    PageUp: -screenful,
    Home: Number.NEGATIVE_INFINITY,
    End: Number.POSITIVE_INFINITY,
  };
  return steps[event.key] ?? null;
}

/** Focus a row's link: at once when it is in the document, else when it has been scrolled to and read. */
function useGoTo(body: RefObject<HTMLDivElement | null>, scrollTo: (index: number) => void) {
  const wanted = useRef<number | null>(null);
  const focus = () => {
    const link = body.current?.querySelector<HTMLElement>(`[data-index="${wanted.current}"] a`);
    if (!link) return false;
    wanted.current = null;
    link.focus();
    return true;
  };
  useLayoutEffect(() => {
    if (wanted.current !== null) focus();
  });
  return {
    go: (index: number) => {
      wanted.current = index;
      if (!focus()) scrollTo(index);
    },
    cancel: () => {
      wanted.current = null;
    },
  };
}

/** Where the list begins on the page, px: what stands above it may change its height. */
function useTop(body: RefObject<HTMLDivElement | null>): number {
  const [top, setTop] = useState(0);
  useLayoutEffect(() => {
    const measure = () => {
      const box = body.current?.getBoundingClientRect();
      if (box) setTop(Math.round(box.top + window.scrollY));
    };
    measure();
    const observer = new ResizeObserver(measure);
    observer.observe(document.body);
    return () => observer.disconnect();
  }, [body]);
  return top;
}

/** Read on before one scrolls to the end of what was read. */
export function useReadAhead(list: ReturnType<typeof useDevices>, read: number, last: number): void {
  const { hasNextPage, isFetching, isPlaceholderData, isError, fetchNextPage } = list;
  const wanted = hasNextPage && !isFetching && !isPlaceholderData && !isError && last + AHEAD >= read;
  useEffect(() => {
    if (wanted) fetchNextPage();
  }, [wanted, fetchNextPage]);
}
