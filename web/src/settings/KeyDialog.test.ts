import { expect, it } from "vitest";
import { draft } from "./KeyDialog";

it("holds to the end of its last day, and names a device only where it is for one", () => {
  const fields = { role: "manager", name: " Desk ", device: "van-1", lastDay: "2025-12-31" } as const;
  expect(draft(fields)).toEqual({
    role: "manager",
    name: "Desk",
    device_id: null,
    expires_at: new Date(2026, 0, 1).toISOString(),
  });
  expect(draft({ ...fields, role: "device", lastDay: "" })).toMatchObject({
    device_id: "van-1",
    expires_at: null,
  });
});
