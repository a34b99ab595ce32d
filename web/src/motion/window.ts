/** Which stretch of driving is looked at: it stands in the address, so that it can be shared and gone back to. */
import type { TimeRange } from "../api/keys";

export const LENGTHS = [600, 3600, 21_600] as const;
export type Length = (typeof LENGTHS)[number];

/** The same in every language. */
export const LENGTH_TEXT: Record<Length, string> = { 600: "10 min", 3600: "1 h", 21600: "6 h" };

export interface View {
  /** s */
  length: Length;
  /** its end, s since 1970; null: it ends with the last data */
  end: number | null;
}

export function readView(search: string): View {
  const params = new URLSearchParams(search);
  const length = LENGTHS.find((known) => known === Number(params.get("length"))) ?? LENGTHS[0];
  const end = Date.parse(params.get("end") ?? "");
  return { length, end: Number.isNaN(end) ? null : end / 1000 };
}

export function writeView({ length, end }: View): URLSearchParams {
  const params = new URLSearchParams();
  if (length !== LENGTHS[0]) params.set("length", String(length));
  if (end !== null) params.set("end", new Date(end * 1000).toISOString());
  return params;
}

/** What to ask for; the last data are not yet known: nothing to ask for. */
export function rangeOf({ length, end }: View, lastData: string | null): TimeRange | null {
  if (end === null && lastData === null) return null;
  const last = end ?? newest(lastData ?? "", length);
  const moment = (seconds: number) => new Date(seconds * 1000).toISOString();
  return { from: moment(last - length), to: moment(last) };
}

/** A long view is computed anew each minute only, however often data come in. */
function newest(lastData: string, length: Length): number {
  const last = Date.parse(lastData) / 1000;
  return length === LENGTHS[0] ? last : 60 * Math.ceil(last / 60);
}

/** Half a view earlier (-1) or later (+1); beyond the last data it follows them again. */
export function moved(view: View, way: 1 | -1, lastData: string | null): View {
  const last = lastData === null ? null : Date.parse(lastData) / 1000;
  const from = view.end ?? last;
  if (from === null) return view;
  const end = from + (way * view.length) / 2;
  return { ...view, end: last !== null && end >= last ? null : end };
}

/** The shortest view with a moment in its middle. */
export function around(moment: number): View {
  return { length: LENGTHS[0], end: moment + LENGTHS[0] / 2 };
}
