import { describe, expect, it } from "vitest";
import type { AuditEntry } from "../api/types";
import { actionText, detailRows, placeOf } from "./audit";

describe("an entry of the audit trail", () => {
  it("says what was done, and of what it does not know the name", () => {
    expect(actionText("key.revoke")).toBe("Revoked a key");
    expect(actionText("fleet.sold")).toBe("fleet.sold");
  });

  it.each([
    ["devices/van 7/b", "/devices/van%207%2Fb"],
    ["alerts/5", "/alerts?id=5"],
    ["webhooks/1", "/settings/webhooks"],
    ["keys/1", "/settings/keys"],
    ["fleets/1", null],
  ])("leads from %s to %s", (target, place) => expect(placeOf(target)).toBe(place));

  it("shows what is known besides", () => {
    const detail = { name: "Van", device_id: null, note: "", kinds: ["gps_lost"], deliveries: 0 };
    expect(detailRows({ detail } as unknown as AuditEntry)).toEqual([
      { name: "name", text: "Van" },
      { name: "kinds", text: '["gps_lost"]' },
      { name: "deliveries", text: "0" },
    ]);
  });
});
