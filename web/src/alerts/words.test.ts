import { afterAll, beforeAll, describe, expect, it } from "vitest";
import type { Alert } from "../api/types";
import { setLanguage } from "../text";
import { KINDS } from "./filters";
import { finding, meaning, movement, remedy } from "./words";

const alert = (kind: Alert["kind"], data: Alert["data"] = {}) => ({ kind, data }) as Alert;

/** What the service says, and what it is called in English and in Italian. */
const FOUND: [Alert, string, string][] = [
  [
    alert("orientation_changed", { angle_deg: 14, axis: [0, 0, 1] }),
    "The device was turned 14° to the left",
    "Il dispositivo è stato ruotato di 14° verso sinistra",
  ],
  [
    alert("orientation_changed", { angle_deg: null }),
    "The device was moved",
    "Il dispositivo è stato spostato",
  ],
  [
    alert("device_loose", { fault: "device_loose" }),
    "The device is loose: it keeps moving",
    "Il dispositivo è allentato: continua a muoversi",
  ],
  [
    alert("sensor_fault", { fault: "left_handed" }),
    "The sensor’s axes are a mirror image",
    "Gli assi del sensore sono speculari",
  ],
  [
    alert("sensor_fault", { fault: "stuck_axis" }),
    "An axis of the sensor is stuck",
    "Un asse del sensore è bloccato",
  ],
  [
    alert("sensor_fault", { fault: "saturated" }),
    "Readings rest at the end of the sensor’s range",
    "Le letture restano al limite del campo di misura del sensore",
  ],
  [
    alert("sensor_fault", { fault: "something_new" }),
    "The sensor’s readings cannot be right",
    "Le letture del sensore non possono essere giuste",
  ],
  [
    alert("calibration_stalled", { seen: 1859 }),
    "Not confirmed after 31 min of driving",
    "Non confermato dopo 31 min di guida",
  ],
  [
    alert("verification_failing", { seen: 4 }),
    "4 drive tests in a row have failed",
    "4 prove su strada di fila non superate",
  ],
  [
    alert("gps_lost", { seen: 5400 }),
    "No GPS fix in 1 h 30 min of data",
    "Nessuna posizione GPS in 1 h 30 min di dati",
  ],
  [
    alert("clock_fault", { seen: 0.98, unit: "share of samples" }),
    "The clock stands still",
    "L’orologio è fermo",
  ],
  [
    alert("clock_fault", { seen: 9.6, unit: "per cent" }),
    "The clock is fast by 10 %",
    "L’orologio corre troppo, del 10 %",
  ],
  [
    alert("clock_fault", { seen: 40, unit: "s", reason: "The device's clock has run back by 40 s, and…" }),
    "The clock has run back by 40 s",
    "L’orologio è tornato indietro di 40 s",
  ],
  [
    alert("clock_fault", { seen: 1234.5, unit: "s", reason: "The device's clock has got 1234 s ahead of…" }),
    "The clock is 1,235 s ahead of the time of day",
    "L’orologio è avanti di 1235 s rispetto all’ora",
  ],
  [
    alert("impact", { direction_deg: 38, speed_change_mps: [-5.55, -4.17] }),
    "The vehicle was hit from the front left, its speed changed by 25 km/h",
    "Il veicolo è stato urtato davanti a sinistra, la sua velocità è cambiata di 25 km/h",
  ],
  [
    alert("impact", { direction_deg: -172.4, speed_change_mps: [2, 0.1] }),
    "The vehicle was hit from the rear, its speed changed by 7 km/h",
    "Il veicolo è stato urtato da dietro, la sua velocità è cambiata di 7 km/h",
  ],
  [
    alert("impact", { direction_deg: -22, speed_change_mps: [-3, 1] }),
    "The vehicle was hit from the front, its speed changed by 11 km/h",
    "Il veicolo è stato urtato davanti, la sua velocità è cambiata di 11 km/h",
  ],
  [alert("impact", {}), "The vehicle was hit", "Il veicolo è stato urtato"],
  [
    alert("harsh_driving", { seen: 3 }),
    "3 harsh manoeuvres within 10 minutes of driving",
    "3 manovre brusche in 10 minuti di guida",
  ],
  [
    alert("clock_fault", { seen: 3, unit: "s" }),
    "The device’s clock is wrong",
    "L’orologio del dispositivo è sbagliato",
  ],
];

describe("what was found", () => {
  it.each(FOUND)("%j: %s", (found, english) => expect(finding(found)).toBe(english));

  it("tells since when a device is silent", () => {
    const silent = alert("device_silent", { since: "2025-11-22T10:20:00Z" });
    expect(finding(silent)).toMatch(/^Nothing has come since 22 Nov 2025, \d\d:20$/);
  });

  it("can say of every kind what it means and what to do, though nothing else is known", () => {
    const said = KINDS.map((kind) => [finding(alert(kind)), meaning(alert(kind)), remedy(alert(kind))]);
    expect(new Set(said.flat()).size).toBe(3 * KINDS.length);
    expect(said.flat().filter((text) => text.includes("{{") || text.includes("alerts."))).toEqual([]);
  });

  it("has words of their own for the faults of a sensor", () => {
    const faults = ["left_handed", "stuck_axis", "saturated", "other"];
    expect(new Set(faults.map((fault) => remedy(alert("sensor_fault", { fault })))).size).toBe(4);
  });
});

describe("a movement", () => {
  it.each([
    [14, [0, 0, 1], "turned 14° to the left"],
    [14, [0, 0, -1], "turned 14° to the right"],
    [3.4, [1, 0, 0], "leaned 3.4° to the right"],
    [90, [0, -1, 0], "tipped 90° nose up"],
    [50, [0.6, 0.1, 0.79], "turned 40° to the left and leaned 30° to the right (50° in all)"],
    [-20, [0, 1, 0], "tipped 20° nose up"],
  ] as const)("of %d° about %j", (angle, axis, words) => expect(movement(angle, axis)).toBe(words));

  it("about an axis that is not known", () => expect(movement(20, null)).toBe("moved by 20°"));
});

describe("in Italian", () => {
  beforeAll(() => setLanguage("it"));
  afterAll(() => setLanguage("en"));

  it.each(FOUND)("%j: %s: %s", (found, _, italian) => expect(finding(found)).toBe(italian));

  it("tells since when a device is silent", () => {
    const silent = alert("device_silent", { since: "2025-11-22T10:20:00Z" });
    expect(finding(silent)).toMatch(/^Il dispositivo tace, ultimi dati: 22 nov 2025, \d\d:20$/);
  });

  it("tells a mixed movement in one sentence", () => {
    const moved = alert("orientation_changed", { angle_deg: 50, axis: [0.6, 0.1, 0.79] });
    expect(finding(moved)).toBe(
      "Il dispositivo è stato ruotato di 40° verso sinistra e inclinato di 30° verso destra (50° in tutto)",
    );
  });
});
