/** What is wrong with a calibration, and what helps. */
import type { Installation, LastData } from "../../api/types";
import { percent, significant, whole } from "../../lib/format";
import { ago, onTheClock } from "../../lib/time";
import { t } from "../../text";
import { ageOf, silence } from "./silence";

export interface Trouble {
  title: string;
  remedy: string;
  tone: "warn" | "bad";
}

/** Hz; below these a calibration takes long or does not end. A receiver of 1 Hz is measured as a little more or less. */
export const LEAST = { samples: 20, fixes: 0.9 };
/** Shares of the samples or fixes that may be left out without a word. */
const LEFT_OUT = { samples: 0.02, fixes: 0.1 };
/** So few are chance. */
const FEW = 5;
/** s in one stage while data comes in and the vehicle moves */
const LONG = 30 * 60;

/** A confirmed mounting has none: a vehicle that is parked afterwards may be silent. */
export function troubles(installation: Installation, now: Date): Trouble[] {
  if (installation.stage === "confirmed") return [];
  const { data, last_data_at } = installation;
  const heard = last_data_at !== null && silence(ageOf(last_data_at, now)) === "none";
  const found = [
    moved(installation),
    last_data_at === null ? null : silent(last_data_at, now),
    ...(heard && data ? ofData(data) : []),
    failed(installation),
    heard ? stalled(installation, now) : null,
  ];
  return found.filter((trouble) => trouble !== null);
}

function moved({ mount }: Installation): Trouble | null {
  if (mount?.status !== "suspect") return null;
  const time = onTheClock(new Date(mount.confirmed_at));
  return {
    title: t("device.trouble.suspect"),
    remedy: t("device.trouble.suspect_do", { time }),
    tone: "bad",
  };
}

function silent(lastDataAt: string, now: Date): Trouble | null {
  const tone = silence(ageOf(lastDataAt, now));
  if (tone === "none") return null;
  const title = t("device.trouble.silent", { ago: ago(new Date(lastDataAt), now) });
  return { title, remedy: t("device.trouble.silent_do"), tone };
}

function ofData(data: LastData): (Trouble | null)[] {
  return [noFix(data), fewSamples(data), fewFixes(data), ...leftOut(data)];
}

function noFix({ has_fix }: LastData): Trouble | null {
  if (has_fix) return null;
  return { title: t("device.trouble.no_fix"), remedy: t("device.trouble.no_fix_do"), tone: "warn" };
}

function fewSamples({ sample_rate_hz }: LastData): Trouble | null {
  if (sample_rate_hz === null || sample_rate_hz >= LEAST.samples) return null;
  const title = t("device.trouble.sample_rate", { rate: significant(sample_rate_hz, 2) });
  return { title, remedy: t("device.trouble.sample_rate_do", { least: whole(LEAST.samples) }), tone: "bad" };
}

function fewFixes({ has_fix, fix_rate_hz }: LastData): Trouble | null {
  if (!has_fix || !fix_rate_hz || fix_rate_hz >= LEAST.fixes) return null;
  const title = t("device.trouble.fix_rate", { rate: significant(fix_rate_hz, 2) });
  return { title, remedy: t("device.trouble.fix_rate_do"), tone: "warn" };
}

/** One for each reason that is too frequent. */
function leftOut(data: LastData): Trouble[] {
  return Object.entries(data.rejected).flatMap(([reason, count]) => {
    const kind = reason.startsWith("fix_") ? "fixes" : "samples";
    const rate = kind === "fixes" ? data.fix_rate_hz : data.sample_rate_hz;
    const used = (rate ?? 0) * data.span_s;
    const share = count / (count + used);
    if (count < FEW || share < LEFT_OUT[kind]) return [];
    const title = t("device.trouble.rejected", { share: percent(share) });
    return [{ title, remedy: remedyFor(reason), tone: "warn" as const }];
  });
}

const REASONS = [
  "duplicate_time",
  "before_previous_sample",
  "fix_without_velocity",
  "fix_implausible",
] as const;

function remedyFor(reason: string): string {
  const known = REASONS.find((one) => one === reason);
  return known ? t(`device.trouble.${known}`) : t("device.trouble.other_reason", { reason });
}

function failed({ verification }: Installation): Trouble | null {
  if (verification.state !== "failed") return null;
  return { title: t("device.trouble.failed"), remedy: t("device.trouble.failed_do"), tone: "warn" };
}

/** Data comes and the vehicle moves, and yet the stage does not change. */
function stalled({ needs, since }: Installation, now: Date): Trouble | null {
  const waits = needs.some((need) => need === "data" || need === "gps_fix" || need === "motion");
  if (waits || now.getTime() - Date.parse(since) < LONG * 1000) return null;
  return { title: t("device.trouble.stalled"), remedy: t("device.trouble.stalled_do"), tone: "warn" };
}
