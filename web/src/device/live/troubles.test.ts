import { afterAll, beforeAll, describe, expect, it } from "vitest";
import type { Installation, LastData } from "../../api/types";
import { setLanguage } from "../../text";
import { installation, lastData, mount, NOW } from "../fixture";
import { troubles } from "./troubles";

const titles = (over: Partial<Installation>, now = NOW) =>
  troubles(installation(over), now).map(({ title }) => title);
const ofData = (over: Partial<LastData>) => titles({ data: lastData(over) });
const later = (seconds: number) => new Date(NOW.getTime() - 10_000 + seconds * 1000);

it("finds nothing wrong with a drive as it should be", () => expect(titles({})).toEqual([]));

it("leaves a device alone that has never sent anything: the sentence says what to do", () =>
  expect(titles({ last_data_at: null, data: null, needs: ["data"], stage: "waiting" })).toEqual([]));

describe("silence", () => {
  it.each([
    [119, []],
    [121, ["warn"]],
    [299, ["warn"]],
    [301, ["bad"]],
  ])("of %d s: %j", (seconds, tones) =>
    expect(troubles(installation(), later(seconds)).map(({ tone }) => tone)).toEqual(tones),
  );

  it("says how long, and nothing of what was sent before", () =>
    expect(titles({ data: lastData({ has_fix: false }) }, later(300))).toEqual([
      "The device is silent: last data 5 minutes ago",
    ]));

  it("is as it should be once the mounting is confirmed", () =>
    expect(titles({ stage: "confirmed" }, later(86_400))).toEqual([]));

  it("is none when the service's clock runs ahead", () => expect(titles({}, later(-600))).toEqual([]));
});

describe("data", () => {
  it.each([
    [{ has_fix: false, fix_rate_hz: 0 }, ["The receiver has no GPS fix"]],
    [{ sample_rate_hz: 10 }, ["Only 10 samples a second"]],
    [{ sample_rate_hz: 20 }, []],
    [{ fix_rate_hz: 0.5 }, ["Only 0.5 GPS fixes a second"]],
    [{ fix_rate_hz: 0.98 }, []],
    [{ sample_rate_hz: null, fix_rate_hz: null }, []],
  ])("%j: %j", (data, expected) => expect(ofData(data)).toEqual(expected));
});

describe("what is not used", () => {
  const remedies = (rejected: Record<string, number>) =>
    troubles(installation({ data: lastData({ rejected }) }), NOW).map(({ remedy }) => remedy);

  it("is told by reason, with its remedy", () => {
    const [first, second, ...none] = remedies({ duplicate_time: 1000, fix_implausible: 100 });
    expect(first).toContain("clock of the device");
    expect(second).toContain("fixes jump");
    expect(none).toEqual([]);
  });

  it("is a share of the samples, or of the fixes", () => {
    expect(remedies({ duplicate_time: 100 })).toEqual([]);
    expect(remedies({ fix_implausible: 100 })).toHaveLength(1);
    expect(ofData({ rejected: { fix_without_velocity: 300 }, fix_rate_hz: 0 })).toEqual([
      "100% of the readings are not used",
    ]);
  });

  it("is nothing where it is a few", () => expect(remedies({ fix_implausible: 4 })).toEqual([]));

  it("names a reason that the page does not know", () =>
    expect(remedies({ too_hot: 1000 })).toEqual(["The service gives as the reason: too_hot."]));
});

describe("the calibration", () => {
  const failed = { ...installation().verification, state: "failed" as const };

  it("goes on after a test that failed, and says so", () =>
    expect(troubles(installation({ verification: failed }), NOW)[0]?.remedy).toContain(
      "made again by itself",
    ));

  it("no longer trusts a mounting of a device that moved", () =>
    expect(titles({ mount: mount("suspect") })).toEqual(["The device seems to have moved"]));

  it("is stalled when a stage goes on and on while the vehicle moves", () => {
    const since = "2025-11-22T09:30:00Z";
    expect(titles({ since })).toEqual(["This takes longer than usual"]);
    expect(titles({ since, needs: ["motion"] })).toEqual([]);
    expect(titles({ since: "2025-11-22T09:45:00Z" })).toEqual([]);
  });
});

describe("in Italian", () => {
  beforeAll(() => setLanguage("it"));
  afterAll(() => setLanguage("en"));

  it("has its own numbers", () =>
    expect(ofData({ fix_rate_hz: 0.5 })).toEqual(["Solo 0,5 posizioni GPS al secondo"]));
});
