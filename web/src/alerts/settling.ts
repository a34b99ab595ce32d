/** What became of alerts that were acknowledged or resolved. */
import type { Verb } from "../api/alerts";
import type { Alert } from "../api/types";
import type { Outcome } from "../lib/each";
import { t } from "../text";

export interface Report {
  done: Alert[];
  /** somebody else was quicker: as they are now */
  late: Alert[];
  failed: { alert: Alert; error: Error }[];
}

/** The service leaves an alert as it is that somebody else has seen or ended meanwhile: then it does not bear our name and note. */
export function report(
  outcomes: readonly Outcome<Alert, Alert>[],
  verb: Verb,
  name: string,
  note: string,
): Report {
  const after = outcomes.flatMap((outcome) => (outcome.done ? [outcome.value] : []));
  const isOurs = (alert: Alert) => bears(alert, verb, name, note);
  return {
    done: after.filter(isOurs),
    late: after.filter((alert) => !isOurs(alert)),
    failed: outcomes.flatMap((outcome) =>
      outcome.done ? [] : [{ alert: outcome.item, error: outcome.error }],
    ),
  };
}

function bears(alert: Alert, verb: Verb, name: string, note: string): boolean {
  if (verb === "acknowledge") {
    const { state, acknowledged_by, acknowledge_note } = alert;
    return state === "acknowledged" && acknowledged_by === name && (acknowledge_note ?? "") === note;
  }
  return alert.state === "resolved" && alert.resolved_by === name && (alert.resolve_note ?? "") === note;
}

/** May this still be done to the alert? */
export function isDue(alert: Alert, verb: Verb): boolean {
  return verb === "acknowledge" ? alert.state === "open" : alert.state !== "resolved";
}

/** The name under which the service resolves what is over by itself. */
export const SERVICE = "service";

/** Who was quicker. */
export function lateText({ state, acknowledged_by, resolved_by }: Alert): string {
  if (state !== "resolved") return t("alerts.settle.already_acknowledged", { who: acknowledged_by ?? "–" });
  if (resolved_by === SERVICE) return t("alerts.settle.already_service");
  return t("alerts.settle.already_resolved", { who: resolved_by ?? "–" });
}
