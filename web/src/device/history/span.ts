/** Spans of time, and how a reader moves through them: s since 1970. */
import type { TimeRange } from "../../api/keys";

export interface Span {
  min: number;
  max: number;
}

/** A moment that stays where it is on the screen, `x` pixels from the left end of the chart. */
export interface Held {
  time: number;
  x: number;
}

/** s; nothing is to be seen in less */
const SHORTEST = 20;
/** Pixels; fingers that are closer than this do not stretch any more. */
const CLOSE = 24;

export const lengthOf = ({ min, max }: Span): number => max - min;

/** Make it so many times as long about a moment. */
export function stretched(span: Span, factor: number, about = (span.min + span.max) / 2): Span {
  const used = Math.max(factor, SHORTEST / lengthOf(span));
  return { min: about - (about - span.min) * used, max: about + (span.max - about) * used };
}

/** Move it by a share of its length; later where that is positive. */
export function moved(span: Span, share: number): Span {
  const by = share * lengthOf(span);
  return { min: span.min + by, max: span.max + by };
}

/** Move it so that a moment is in its middle. */
export function centred(span: Span, time: number): Span {
  const half = lengthOf(span) / 2;
  return { min: time - half, max: time + half };
}

/** The span in which moments are where fingers hold them: one finger moves it, two stretch it too. */
export function held(span: Span, [one, two]: readonly [Held, Held?], width: number): Span {
  let perPixel = lengthOf(span) / width;
  if (two && Math.abs(two.x - one.x) >= CLOSE) perPixel = (two.time - one.time) / (two.x - one.x);
  if (perPixel * width < SHORTEST) perPixel = SHORTEST / width;
  const min = one.time - one.x * perPixel;
  return { min, max: min + perPixel * width };
}

/** Keep it where there is something; too long a one shows everything. */
export function inside(span: Span, limits: Span): Span {
  const size = Math.min(lengthOf(span), Math.max(lengthOf(limits), SHORTEST));
  const min = Math.min(Math.max(span.min, limits.min), Math.max(limits.max - size, limits.min));
  return { min, max: min + size };
}

/**
 * What is loaded for a look at a span: at least half as much again on both sides, so that moving shows something at once. It
 * keeps to a grid, so that what was loaded once is found again.
 */
export function loadedFor(span: Span): Span {
  const step = 2 ** Math.ceil(Math.log2(lengthOf(span))) / 2;
  return { min: (Math.floor(span.min / step) - 1) * step, max: (Math.ceil(span.max / step) + 1) * step };
}

/** Points for a pixel: of what is read again and again while data come in, and of what is read once and zoomed into. */
const LIVE = 2;
const PAST = 4;
/** The service gives no more. */
export const MOST_POINTS = 10_000;

/** How many points to ask for, for a chart so many pixels wide; `span` null: all that is loaded is shown. */
export function pointsFor(span: Span | null, pixels: number): number {
  const wanted = span === null ? LIVE * pixels : (PAST * pixels * lengthOf(loadedFor(span))) / lengthOf(span);
  return Math.min(MOST_POINTS, 500 * Math.ceil(wanted / 500));
}

export function asRange({ min, max }: Span): TimeRange {
  return { from: moment(min), to: moment(max) };
}

export function moment(seconds: number): string {
  return new Date(seconds * 1000).toISOString();
}

export const RANGES = ["hour", "day", "week", "month", "all"] as const;
export type Range = (typeof RANGES)[number];
const SECONDS: Record<Range, number> = {
  hour: 3600,
  day: 86_400,
  week: 7 * 86_400,
  month: 30 * 86_400,
  all: Number.POSITIVE_INFINITY,
};

/**
 * Where a range begins, counted back from the last data and put on a whole minute, so that a live page does not ask for
 * another window with every sample. Null: at the beginning.
 */
export function rangeStart(range: Range, lastData: string | null): string | null {
  if (lastData === null || range === "all") return null;
  const minute = Math.floor(Date.parse(lastData) / 60_000) * 60_000;
  return new Date(minute - SECONDS[range] * 1000).toISOString();
}
