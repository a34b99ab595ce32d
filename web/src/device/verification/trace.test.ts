import { describe, expect, it } from "vitest";
import { installation, mount } from "../fixture";
import { countdown, speeds, speedsSay, spokenOf } from "./trace";

const test = installation().verification;
const running = (elapsed_s: number) => countdown({ ...test, state: "running", elapsed_s });

describe("countdown", () => {
  it("counts the driving that is left", () =>
    expect(running(10.2)).toEqual({ left: 30, share: 0.255, goesOn: false }));

  it("goes on to the longest test where the result is not sure enough", () =>
    expect(running(60)).toEqual({ left: 60, share: 0.5, goesOn: true }));

  it("never counts below nothing", () => expect(running(125)).toMatchObject({ left: 0, share: 1 }));
});

describe("the test spoken of", () => {
  const confirmed = mount("in_force");

  it("is the mounting's where no other was begun since", () => {
    expect(spokenOf(installation({ mount: confirmed }))).toBe(confirmed.verification);
    const begun = { ...test, state: "running" as const };
    expect(spokenOf(installation({ mount: confirmed, verification: begun }))).toBe(begun);
  });

  it("is not that of a mounting that is no longer trusted", () =>
    expect(spokenOf(installation({ mount: mount("suspect") })).state).toBe("idle"));
});

describe("speeds", () => {
  const trace = { t: [300, 301, 302], gps_mps: [10, 11, 12], sensor_mps: [10, 11.5, 11] };

  it("are km/h over seconds of the test", () => {
    expect(speeds(trace)).toEqual({ time: [0, 1, 2], gps: [36, 39.6, 43.2], sensor: [36, 41.4, 39.6] });
  });

  it.each([null, { t: [], gps_mps: [], sensor_mps: [] }, { t: [1], gps_mps: [1], sensor_mps: [1] }])(
    "need two rows to be drawn: %j",
    (little) => expect(speeds(little)).toBeNull(),
  );

  it("are told to those who cannot see them", () => {
    const shown = speeds(trace);
    expect(shown && speedsSay(shown)).toBe(
      "Speed over 2 s of driving: GPS from 36 to 43 km/h, sensor from 36 to 40 km/h; farthest apart by 3.6 km/h",
    );
  });
});
