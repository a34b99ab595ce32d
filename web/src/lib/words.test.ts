import { describe, expect, it } from "vitest";
import { fromAngles } from "./rotation";
import { describe as inWords, pointing } from "./words";

const mounting = (roll: number, pitch: number, yaw: number) => inWords(fromAngles({ roll, pitch, yaw }));

describe("turned", () => {
  it("says nothing of angles that are nothing", () => {
    expect(mounting(0.2, -0.3, 0.4).turned).toBe(
      "The device sits straight: its axes are the vehicle’s axes.",
    );
  });

  it("says left and right, down and up, as seen by somebody in the vehicle", () => {
    expect(mounting(3, 8, -94).turned).toBe(
      "The device is turned 94° to the right, has its front tilted 8.0° down and is rolled 3.0° onto its right side.",
    );
    expect(mounting(-3, -8, 94).turned).toBe(
      "The device is turned 94° to the left, has its front tilted 8.0° up and is rolled 3.0° onto its left side.",
    );
  });

  it("says when it faces backward or lies upside down", () => {
    expect(mounting(0, 0, 180).turned).toBe("The device faces backward.");
    expect(mounting(0, 0, -172).turned).toBe("The device is turned 172° to the right (it faces backward).");
    expect(mounting(179.8, 0, 0).turned).toBe("The device lies upside down.");
    expect(mounting(170, 0, 0).turned).toBe("The device is rolled 170° onto its right side (upside down).");
  });

  it.each([90, -90, 86, -87])("does not tell yaw from roll at a pitch of %d", (pitch) => {
    const words = mounting(12, pitch, 34);
    expect(words.ambiguous).toBe(true);
    expect(words.turned).toContain(pitch > 0 ? "straight down" : "straight up");
    expect(words.turned).toContain("yaw and roll are not unique");
    expect(words.turned).not.toContain("34°");
  });
});

describe("axes", () => {
  it("names the vehicle direction of every axis", () => {
    expect(mounting(0, 0, 0).axes).toBe("Its x axis points forward, y axis left and z axis up.");
    expect(mounting(0, 0, -94).axes).toBe("Its x axis points right, y axis forward and z axis up.");
    expect(mounting(180, 0, 0).axes).toBe("Its x axis points forward, y axis right and z axis down.");
    expect(mounting(0, 90, 0).axes).toBe("Its x axis points down, y axis left and z axis forward.");
  });

  it("names two directions where an axis lies between them, the nearer first", () => {
    expect(mounting(0, 0, 40).axes).toBe(
      "Its x axis points forward and left, y axis left and backward and z axis up.",
    );
  });

  it("is unique where the angles are not", () => {
    expect(mounting(30, 90, 10).axes).toBe(mounting(20, 90, 0).axes);
  });
});

describe("pointing", () => {
  it("takes a corner", () => expect(pointing([0.6, -0.58, -0.55])).toBe("forward and right and down"));
});
