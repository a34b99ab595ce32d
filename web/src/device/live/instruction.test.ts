import { describe, expect, it } from "vitest";
import type { Need } from "../../api/types";
import { installation } from "../fixture";
import { instruction } from "./instruction";

const told = (needs: Need[], over: Parameters<typeof installation>[0] = {}, silent = false) =>
  instruction(installation({ needs, ...over }), silent);

describe("the sentence", () => {
  it("speaks of the most urgent need, the others follow", () => {
    const { say, also } = told(["accelerate_or_brake", "turn", "gps_fix"]);
    expect(say).toContain("under open sky");
    expect(also).toEqual(["turn", "accelerate_or_brake"]);
  });

  it("asks for one thing at a time", () => {
    expect(told(["accelerate_or_brake"]).say).toBe("Brake firmly once or twice on a straight road.");
    expect(told(["accelerate_or_brake"]).also).toEqual([]);
  });

  it("tells a device that never sent anything from one that did", () => {
    expect(told(["data"], { last_data_at: null }).say).toContain("switch the device on");
    expect(told(["data"]).say).toContain("begins with the next data");
  });

  it("says that the result is being tested", () =>
    expect(told(["time"], { stage: "verifying" }).say).toContain("is being tested"));

  it("does not ask a silent device's driver for corners first", () => {
    const { say, also } = told(["data", "turn"], {}, true);
    expect(say).toContain("goes on with the next data");
    expect(also).toEqual(["turn"]);
  });

  it("is the service's where the page does not know a need", () => {
    const { say, also } = told(["tyre_pressure" as Need, "turn"]);
    expect(say).toBe("In the service's words.");
    expect(also).toEqual(["turn"]);
  });

  it.each([[[]], [["gps_fix"]]] as [Need[]][])("asks for nothing once confirmed: %j", (needs) => {
    const { say, also } = told(needs, { stage: "confirmed" }, true);
    expect(say).toContain("Nothing needs to be done");
    expect(also).toEqual([]);
  });
});
