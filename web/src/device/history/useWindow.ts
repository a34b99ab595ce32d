/** Which part of the history is looked at, and which is asked for. */
import { useCallback, useEffect, useState } from "react";
import { useEnds } from "../../api/history";
import type { TimeRange } from "../../api/keys";
import { asRange, loadedFor, pointsFor, type Range, rangeStart, type Span } from "./span";
import { TimeAxis } from "./timeAxis";

export interface HistoryWindow {
  range: Range;
  choose: (range: Range) => void;
  time: TimeAxis;
  /** where the reader has moved or zoomed to; null: the range is shown as it is */
  view: Span | null;
  reset: () => void;
  /** what is shown */
  shown: TimeRange;
  /** what is to be loaded for it */
  wanted: { range: TimeRange; points: number; past: boolean };
}

export function useWindow(lastData: string | null): HistoryWindow {
  const [range, setRange] = useState<Range>("hour");
  const [view, setView] = useState<Span | null>(null);
  const [time] = useState(() => new TimeAxis());
  useEffect(() => {
    time.onRest = setView;
    return () => time.stop();
  }, [time]);
  const reset = useCallback(() => {
    time.reset();
    setView(null);
  }, [time]);
  const choose = (chosen: Range) => {
    setRange(chosen);
    reset();
  };
  const preset = { from: rangeStart(range, lastData), to: null };
  const points = pointsFor(view, document.documentElement.clientWidth);
  const wanted =
    view === null
      ? { range: preset, points, past: false }
      : { range: asRange(loadedFor(view)), points, past: isPast(loadedFor(view), lastData) };
  return { range, choose, time, view, reset, shown: view ? asRange(view) : preset, wanted };
}

function isPast({ max }: Span, lastData: string | null): boolean {
  return lastData !== null && max < Date.parse(lastData) / 1000;
}

/** Let the time axis move as far as there are estimates: those of all times, and those that have come in since. */
export function useLimits(id: string, { time, view }: HistoryWindow, extent: Span | null): void {
  const ends = useEnds(id, extent !== null);
  const known = ends.data?.time.map((moment) => Date.parse(moment) / 1000) ?? [];
  const all = extent ? [...known, extent.min, extent.max] : known;
  useEffect(() => {
    time.limits = all.length > 0 ? { min: Math.min(...all), max: Math.max(...all) } : null;
    time.loaded = view ? loadedFor(view) : extent;
  });
}
