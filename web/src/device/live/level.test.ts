import { expect, it } from "vitest";
import { STAGES } from "../../lib/stages";
import { levelHelps } from "./level";

const last_data_at = "2025-11-22T10:00:00Z";

it.each(STAGES)("level ground helps until the mounting is confirmed: %s", (stage) =>
  expect(levelHelps({ stage, last_data_at })).toBe(stage !== "confirmed"),
);

it("needs a device that has sent something", () =>
  expect(levelHelps({ stage: "waiting", last_data_at: null })).toBe(false));
