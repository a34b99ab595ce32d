import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { setLanguage } from "../../text";
import { csvName, csvText } from "./csv";
import { estimates } from "./sample";

describe.each(["en", "it"] as const)("in %s", (language) => {
  beforeAll(() => setLanguage(language));
  afterAll(() => setLanguage("en"));

  it("has units in the header, UTC and decimal points", () => {
    const [header, first, ...rest] = csvText(estimates([{ t: 61.5, yaw: -94.25 }])).split("\r\n");
    expect(header).toBe(
      "time_utc,session,t_s,roll_deg,pitch_deg,yaw_deg,roll_sigma_deg,pitch_sigma_deg,yaw_sigma_deg," +
        "q_w,q_x,q_y,q_z,stage,stable,reliable,progress",
    );
    expect(first).toBe(
      "2025-11-22T10:01:01.500Z,s,61.5,0,1,-94.25,0.1,0.2,0.5,1,0,0,0,settling,false,false,0.5",
    );
    expect(rest).toEqual([""]);
  });
});

it.each([
  ["a,b", '"a,b"'],
  ['a"b', '"a""b"'],
  ["=1+1", "'=1+1"],
])("a session named %s is %s", (session, cell) =>
  expect(csvText(estimates([{ t: 0, session }]))).toContain(`Z,${cell},0,`),
);

it("is named after the device and what it holds", () =>
  expect(csvName("van-7", estimates([{ t: 0 }, { t: 90 }]))).toBe(
    "livella-van-7-20251122T100000Z-20251122T100130Z.csv",
  ));
