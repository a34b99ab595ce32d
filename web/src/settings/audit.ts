/** Entries of the audit trail, for people. */
import type { AuditEntry } from "../api/types";
import { t } from "../text";

/** What the service records, `resource.verb`. */
export const ACTIONS = [
  "alert.acknowledge",
  "alert.resolve",
  "device.register",
  "device.edit",
  "device.rotate_key",
  "device.remove",
  "installation.level",
  "installation.restart",
  "key.create",
  "key.revoke",
  "webhook.create",
  "webhook.edit",
  "webhook.rotate_secret",
  "webhook.redeliver",
  "webhook.test",
  "webhook.remove",
  "session.sign_in",
  "session.refused",
  "session.sign_out",
] as const;

/** An action that this page does not know yet stands as the service names it. */
export function actionText(action: string): string {
  const known = ACTIONS.find((name) => name === action);
  return known ? t(`settings.audit.actions.${known}`) : action;
}

/** Where on the page a target is; null where it has no place. */
export function placeOf(target: string): string | null {
  const [resource, ...rest] = target.split("/");
  const id = rest.join("/");
  if (resource === "devices") return `/devices/${encodeURIComponent(id)}`;
  if (resource === "alerts") return `/alerts?id=${encodeURIComponent(id)}`;
  if (resource === "webhooks") return "/settings/webhooks";
  return resource === "keys" ? "/settings/keys" : null;
}

/** What else is known of it, a line each; nested things as the service writes them. */
export function detailRows({ detail }: AuditEntry): { name: string; text: string }[] {
  return Object.entries(detail ?? {})
    .filter(([, value]) => value !== null && value !== "")
    .map(([name, value]) => ({ name, text: typeof value === "string" ? value : JSON.stringify(value) }));
}
