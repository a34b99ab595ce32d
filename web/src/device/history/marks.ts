/** What happened, as marks on the angle history. */
import type { Alert, Estimates, Mount, Stage } from "../../api/types";
import { stageWord } from "../../lib/stages";
import { t } from "../../text";
import type { Span } from "./span";

/** The most important first: where there is room for one flag only, it is that one's. */
export const MARK_KINDS = ["opened", "resolved", "mount", "stage", "session"] as const;
export type MarkKind = (typeof MARK_KINDS)[number];

export interface Mark {
  kind: MarkKind;
  /** s since 1970 */
  time: number;
  /** on the chart, short */
  flag: string;
  /** in the list, whole */
  text: string;
}

interface Happened {
  estimates: Estimates;
  mounts: readonly Mount[];
  alerts: readonly Alert[];
}

/** Everything that happened, in time order. */
export function marksOf({ estimates, mounts, alerts }: Happened): Mark[] {
  const zeros = sessionZeros(estimates);
  const marks = [
    ...rowMarks(estimates),
    ...mounts.map(mountMark),
    ...alerts.flatMap((alert) => alertMarks(alert, zeros)),
  ];
  return marks.sort((a, b) => a.time - b.time);
}

/**
 * Starts of sessions and changes of stage. Sessions that were sent at once overlap, so each is followed by itself. A change
 * to confirmed is told by its mounting.
 */
function rowMarks({ time, session, stage }: Estimates): Mark[] {
  const stages = new Map<string, Stage>();
  const marks: Mark[] = [];
  session.forEach((name, row) => {
    const [moment, now] = [time[row], stage[row]];
    if (moment === undefined || now === undefined) return;
    if (!stages.has(name)) marks.push(sessionMark(moment, name));
    const before = stages.get(name) ?? stage[row - 1] ?? now;
    if (now !== before && now !== "confirmed") marks.push(stageMark(moment, now));
    stages.set(name, now);
  });
  return marks;
}

function sessionMark(moment: string, name: string): Mark {
  const text = t("history.event.session", { name });
  return { kind: "session", time: seconds(moment), flag: t("history.flag.session"), text };
}

function stageMark(moment: string, stage: Stage): Mark {
  const flag = stageWord(stage);
  return { kind: "stage", time: seconds(moment), flag, text: t("history.event.stage", { stage: flag }) };
}

function mountMark({ id, confirmed_at }: Mount): Mark {
  return {
    kind: "mount",
    time: seconds(confirmed_at),
    flag: t("history.flag.mount", { number: id }),
    text: t("history.event.mount", { number: id }),
  };
}

function alertMarks(alert: Alert, zeros: ReadonlyMap<string, number>): Mark[] {
  const what = t(`alerts.kind.${alert.kind}`);
  const opened: Mark = {
    kind: "opened",
    time: foundAt(alert, zeros),
    flag: what,
    text: t("history.event.opened", { what }),
  };
  if (alert.resolved_at === null) return [opened];
  const resolved: Mark = {
    kind: "resolved",
    time: seconds(alert.resolved_at),
    flag: t("history.flag.resolved"),
    text: t("history.event.resolved", { what }),
  };
  return [opened, resolved];
}

/** When it was found: by the clock of its session, as the curve beside it is; else when the service opened it. */
function foundAt({ data, opened_at }: Alert, zeros: ReadonlyMap<string, number>): number {
  const zero = typeof data.session === "string" ? zeros.get(data.session) : undefined;
  if (zero !== undefined && typeof data.t === "number") return zero + data.t;
  return seconds(typeof data.at === "string" ? data.at : opened_at);
}

/** s since 1970 at which the clock of each session was zero */
function sessionZeros({ session, time, t: clock }: Estimates): Map<string, number> {
  const zeros = new Map<string, number>();
  session.forEach((name, row) => {
    const [moment, reading] = [time[row], clock[row]];
    if (!zeros.has(name) && moment !== undefined && reading !== undefined)
      zeros.set(name, seconds(moment) - reading);
  });
  return zeros;
}

/** Those of a span. */
export function within(marks: readonly Mark[], { min, max }: Span): Mark[] {
  return marks.filter(({ time }) => time >= min && time <= max);
}

/** Which marks get their flag: no two on top of each other, the important ones first; in pixels. */
export function flagged<T extends { kind: MarkKind; from: number; to: number }>(placed: readonly T[]): T[] {
  const shown: T[] = [];
  for (const kind of MARK_KINDS) {
    for (const mark of placed) {
      if (mark.kind === kind && shown.every(({ from, to }) => mark.to < from || mark.from > to))
        shown.push(mark);
    }
  }
  return shown;
}

const seconds = (moment: string) => Date.parse(moment) / 1000;
