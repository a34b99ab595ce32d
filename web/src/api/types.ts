/** Short names for the generated types. */
import type { components, operations } from "./schema";

type Schemas = components["schemas"];
type DeviceQuery = NonNullable<operations["list_devices"]["parameters"]["query"]>;

export type Alert = Schemas["Alert"];
export type AuditEntry = Schemas["AuditEntry"];
export type CreatedKey = Schemas["CreatedKey"];
export type Device = Schemas["Device"];
export type DeviceChange = Schemas["DeviceChange"];
export type DeviceDraft = Schemas["DeviceDraft"];
export type DevicePatch = Schemas["DevicePatch"];
export type Estimate = Schemas["Estimate"];
export type Estimates = Schemas["Estimates"];
export type FleetSummary = Schemas["FleetSummary"];
export type Installation = Schemas["Installation"];
export type Key = Schemas["Key"];
export type KeyDraft = Schemas["KeyDraft"];
export type LastData = Schemas["LastData"];
export type Motion = Schemas["Motion"];
export type MotionEvent = Schemas["MotionEvent"];
export type Mount = Schemas["Mount"];
export type Reception = Schemas["Reception"];
export type RegisteredDevice = Schemas["RegisteredDevice"];
export type SignedIn = Schemas["SignedIn"];
export type SpeedTrace = Schemas["SpeedTrace"];
export type Threshold = Schemas["Threshold"];
export type Verification = Schemas["Verification"];
export type Webhook = Schemas["Webhook"];
export type WebhookDelivery = Schemas["WebhookDelivery"];
export type WebhookDraft = Schemas["WebhookDraft"];
export type WebhookTest = Schemas["WebhookTest"];

export type Stage = Installation["stage"];
export type Need = Installation["needs"][number];
export type Role = SignedIn["role"];
export type AlertKind = Alert["kind"];
export type AlertState = Alert["state"];
export type MotionEventKind = MotionEvent["kind"];
export type Severity = Alert["severity"];
export type DeviceOrder = NonNullable<DeviceQuery["sort"]>;
export type CurrentMountStatus = NonNullable<DeviceQuery["mount_status"]>;

/** One page of a list. */
export interface Page<T> {
  items: T[];
  next_cursor: string | null;
}
