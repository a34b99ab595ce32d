/** A mounting in the words of somebody who stands beside the vehicle. */
import { angles, DEGREES, deviceAxes, dot, GIMBAL_PITCH, type Quaternion, type Vector } from "./rotation";

const DIRECTIONS: readonly { name: string; opposite: string; axis: Vector }[] = [
  { name: "forward", opposite: "backward", axis: [1, 0, 0] },
  { name: "left", opposite: "right", axis: [0, 1, 0] },
  { name: "up", opposite: "down", axis: [0, 0, 1] },
];

/** Below this many degrees a rotation is not worth a word. */
const SMALL = 0.5;
/** Within this many degrees of a vehicle axis a device axis "points" there. */
const NEAR = 25;

export interface MountingWords {
  /** How the device is turned, one sentence. */
  turned: string;
  /** Where each of its axes points, one sentence. */
  axes: string;
  /** True where roll and yaw are not unique. */
  ambiguous: boolean;
}

/** Say how a device with mounting q_vs sits in its vehicle. */
export function describe(q: Quaternion): MountingWords {
  const { pitch } = angles(q);
  const ambiguous = Math.abs(pitch) > GIMBAL_PITCH;
  return { turned: ambiguous ? upright(pitch) : rotations(q), axes: axesSentence(q), ambiguous };
}

function upright(pitch: number): string {
  const end = pitch > 0 ? "down" : "up";
  const off = 90 - Math.abs(pitch);
  const exactly = off < SMALL ? "straight" : "almost straight";
  return `The device stands on end: its x axis points ${exactly} ${end}. Near a pitch of ±90° yaw and roll are not unique; the picture and the quaternion are.`;
}

function rotations(q: Quaternion): string {
  const { roll, pitch, yaw } = angles(q);
  const parts = [yawWords(yaw), pitchWords(pitch), rollWords(roll)].filter((part) => part !== null);
  if (parts.length === 0) return "The device sits straight: its axes are the vehicle’s axes.";
  return `The device ${list(parts)}.`;
}

function yawWords(yaw: number): string | null {
  const size = Math.abs(yaw);
  if (size < SMALL) return null;
  if (size > 180 - SMALL) return "faces backward";
  const side = yaw > 0 ? "left" : "right";
  return `is turned ${degreesText(size)} to the ${side}${size > 150 ? " (it faces backward)" : ""}`;
}

function pitchWords(pitch: number): string | null {
  if (Math.abs(pitch) < SMALL) return null;
  return `has its front tilted ${degreesText(Math.abs(pitch))} ${pitch > 0 ? "down" : "up"}`;
}

function rollWords(roll: number): string | null {
  const size = Math.abs(roll);
  if (size < SMALL) return null;
  if (size > 180 - SMALL) return "lies upside down";
  const side = roll > 0 ? "right" : "left";
  return `is rolled ${degreesText(size)} onto its ${side} side${size > 150 ? " (upside down)" : ""}`;
}

function axesSentence(q: Quaternion): string {
  const [x, y, z] = deviceAxes(q);
  return `Its ${list([`x axis points ${pointing(x)}`, `y axis ${pointing(y)}`, `z axis ${pointing(z)}`])}.`;
}

/** Where a device axis points: one vehicle direction when it is near one, else the two that it lies between. */
export function pointing(axis: Vector): string {
  const ranked = DIRECTIONS.map((direction) => {
    const cosine = dot(direction.axis, axis);
    return { name: cosine >= 0 ? direction.name : direction.opposite, size: Math.abs(cosine) };
  }).sort((a, b) => b.size - a.size);
  const near = ranked.filter(({ size }, i) => i === 0 || size > Math.sin(NEAR / DEGREES));
  return near.map(({ name }) => name).join(" and ");
}

/** "3.4°" below ten degrees, "94°" above. */
export function degreesText(degrees: number): string {
  return `${degrees.toFixed(degrees < 9.95 ? 1 : 0)}°`;
}

function list(parts: readonly string[]): string {
  if (parts.length < 2) return parts.join("");
  return `${parts.slice(0, -1).join(", ")} and ${parts.at(-1)}`;
}
