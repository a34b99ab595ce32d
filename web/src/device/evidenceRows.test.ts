import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { setLanguage } from "../text";
import type { AlertData } from "./evidence";
import { evidenceRows, reasonText } from "./evidenceRows";

const MOVED: AlertData = {
  session: "a",
  t: 510,
  at: "2025-11-22T10:08:30.000Z",
  since_t: 492,
  since: "2025-11-22T10:08:12.000Z",
  mount: 3,
  quaternion: [0.5, 0.5, -0.5, 0.5],
  sigma_deg: [0.51, 0.62, 1.2],
  angle_deg: 14.004,
  axis: [0, -0.1, 0.995],
  evidence: { t: [500, 505, 510], value: [0, 25, 61.5], threshold: 60 },
  fault: null,
};
const measured = (seen: number, threshold: number, unit: string) => ({ seen, threshold, unit });
const told = (data: AlertData, kind = "") =>
  Object.fromEntries(evidenceRows(data, kind).map(({ label, text }) => [label, text]));

it("tells what is known in words, a line each", () => {
  const rows = told(MOVED, "orientation_changed");
  expect(rows).toMatchObject({
    Session: "a",
    "Found, session clock": "510.0 s",
    "Mounting in doubt": "no. 3",
    "Turned by": "14°",
    "Turned about": "an axis pointing up (0.00, \u22120.10, 1.00)",
    "New mounting, q_vs": "0.500000, 0.500000, -0.500000, 0.500000",
    "Its uncertainty, 1 σ": "roll 0.5°, pitch 0.6°, yaw 1.2°",
  });
  expect(rows.Began).toContain("22 Nov 2025");
  expect(Object.keys(rows)).toHaveLength(10);
});

it("begins with when, and ends with what only engineers ask for", () => {
  const names = evidenceRows(MOVED, "orientation_changed").map(({ name }) => name);
  expect([names[0], names.at(-1)]).toEqual(["since", "t"]);
});

/** As the service's rules give them. */
const RULES: readonly [string, AlertData, [string, string, string], [string, string, string]][] = [
  [
    "calibration_stalled",
    measured(1834, 1800, "s"),
    ["Driven without a mounting", "30 min", "30 min"],
    ["Guida senza montaggio", "30 min", "30 min"],
  ],
  [
    "verification_failing",
    measured(5, 4, "tests"),
    ["Failed in a row", "5 tests", "4 tests"],
    ["Fallite di seguito", "5 prove", "4 prove"],
  ],
  [
    "gps_lost",
    measured(5400, 1800, "s"),
    ["Data without a GPS fix", "1 h 30 min", "30 min"],
    ["Dati senza posizione GPS", "1 h 30 min", "30 min"],
  ],
  [
    "device_silent",
    measured(72.55, 72, "h"),
    ["Nothing received for", "72.6 h", "72 h"],
    ["Nessun dato da", "72,6 h", "72 h"],
  ],
  [
    "harsh_driving",
    measured(3, 3, "events"),
    ["Harsh manoeuvres", "3 events", "3 events"],
    ["Manovre brusche", "3 eventi", "3 eventi"],
  ],
  [
    "clock_fault",
    measured(1.25, 1, "s"),
    ["Clock is off by", "1.25 s", "1 s"],
    ["Orologio fuori di", "1,25 s", "1 s"],
  ],
  [
    "clock_fault",
    measured(0.955, 0.9, "share of samples"),
    ["Samples that repeat a time", "95.5 %", "90 %"],
    ["Campioni che ripetono un tempo", "95,5 %", "90 %"],
  ],
  [
    "clock_fault",
    measured(5.04, 2, "per cent"),
    ["Clock is fast by", "5.04 %", "2 %"],
    ["L’orologio avanza del", "5,04 %", "2 %"],
  ],
];

it.each(RULES)("%s tells what was measured: %o", (kind, data, [label, seen, threshold]) =>
  expect(told(data, kind)).toEqual({ [label]: seen, "Raised from": threshold }),
);

it("has a general name for what was measured where the kind is not known", () =>
  expect(told(measured(3, 2, "drops"), "leak")).toEqual({ Seen: "3 drops", "Raised from": "2 drops" }));

it("shows what it does not know under its own name, and what it does not understand as it is", () =>
  expect(told({ humidity_percent: 83.21745, axis: [1, 2], since: "long ago", fault: "rust" })).toEqual({
    humidity_percent: "83.22",
    "Turned about": "1, 2",
    Began: "long ago",
    Fault: "rust",
  }));

describe("in Italian", () => {
  beforeAll(() => setLanguage("it"));
  afterAll(() => setLanguage("en"));

  it.each(RULES)("%s tells what was measured: %o", (kind, data, _, [label, seen, threshold]) =>
    expect(told(data, kind)).toEqual({ [label]: seen, "Avvisa a partire da": threshold }),
  );

  it("keeps numbers to copy as they are, and separates decimals from the next number", () =>
    expect(told(MOVED)).toMatchObject({
      "Nuovo montaggio, q_vs": "0.500000, 0.500000, -0.500000, 0.500000",
      "Girato attorno a": "un asse che punta in alto (0,00; \u22120,10; 1,00)",
      "La sua incertezza, 1 σ": "rollio 0,5°, beccheggio 0,6°, imbardata 1,2°",
    }));

  it("finds its own words for the service's reasons, also for several, and keeps their numbers", () => {
    expect(reasonText("filter and coarse alignment disagree")).toBe(
      "filtro e allineamento approssimativo non concordano",
    );
    expect(reasonText("Drive off: the vehicle has to move. Keep driving as usual.")).toBe(
      "Partire: il veicolo deve muoversi. Continuare a guidare come al solito.",
    );
    expect(reasonText("The device's clock is fast by 17 per cent.")).toBe(
      "L’orologio del dispositivo avanza del 17 per cento.",
    );
    expect(reasonText("something new")).toBe("something new");
  });
});
