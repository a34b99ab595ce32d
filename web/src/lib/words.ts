/** A mounting in the words of somebody who stands beside the vehicle. */
import { t } from "../text";
import { degreesText, listed } from "./format";
import { angles, DEGREES, deviceAxes, dot, GIMBAL_PITCH, type Quaternion, type Vector } from "./rotation";

const DIRECTIONS = [
  { name: "forward", opposite: "backward", axis: [1, 0, 0] },
  { name: "left", opposite: "right", axis: [0, 1, 0] },
  { name: "up", opposite: "down", axis: [0, 0, 1] },
] as const;

/** Below this many degrees a rotation is not worth a word. */
const SMALL = 0.5;
/** Within this many degrees of a vehicle axis a device axis "points" there. */
const NEAR = 25;
/** Beyond this many degrees a turned device faces backward, a rolled one lies upside down. */
const OVER = 150;

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

/** How well the mounting is known: one standard deviation of what is known least. */
export function goodTo(sigma: readonly number[]): string {
  return t("mounting.good_to", { degrees: degreesText(Math.max(...sigma)) });
}

function upright(pitch: number): string {
  const end = pitch > 0 ? "down" : "up";
  const exactly = 90 - Math.abs(pitch) < SMALL;
  return `${t(`mounting.on_end.${exactly ? end : (`almost_${end}` as const)}`)} ${t("mounting.not_unique")}`;
}

function rotations(q: Quaternion): string {
  const { roll, pitch, yaw } = angles(q);
  const parts = [yawWords(yaw), pitchWords(pitch), rollWords(roll)].filter((part) => part !== null);
  if (parts.length === 0) return t("mounting.straight");
  return t("mounting.turned", { how: listed(parts) });
}

function yawWords(yaw: number): string | null {
  const size = Math.abs(yaw);
  if (size < SMALL) return null;
  if (size > 180 - SMALL) return t("mounting.yaw.backward");
  const turned = t(`mounting.yaw.${yaw > 0 ? "left" : "right"}`, { degrees: degreesText(size) });
  return size > OVER ? t("mounting.yaw.backward_too", { turned }) : turned;
}

function pitchWords(pitch: number): string | null {
  const size = Math.abs(pitch);
  if (size < SMALL) return null;
  return t(`mounting.pitch.${pitch > 0 ? "down" : "up"}`, { degrees: degreesText(size) });
}

function rollWords(roll: number): string | null {
  const size = Math.abs(roll);
  if (size < SMALL) return null;
  if (size > 180 - SMALL) return t("mounting.roll.over");
  const rolled = t(`mounting.roll.${roll > 0 ? "right" : "left"}`, { degrees: degreesText(size) });
  return size > OVER ? t("mounting.roll.over_too", { rolled }) : rolled;
}

function axesSentence(q: Quaternion): string {
  const [x, y, z] = deviceAxes(q);
  return t("mounting.axes", { x: pointing(x), y: pointing(y), z: pointing(z) });
}

/** Where a device axis points: one vehicle direction when it is near one, else those that it lies between. */
export function pointing(axis: Vector): string {
  const ranked = DIRECTIONS.map((direction) => {
    const cosine = dot(direction.axis, axis);
    return { name: cosine >= 0 ? direction.name : direction.opposite, size: Math.abs(cosine) };
  }).sort((a, b) => b.size - a.size);
  const near = ranked.filter(({ size }, i) => i === 0 || size > Math.sin(NEAR / DEGREES));
  return near.map(({ name }) => t(`mounting.direction.${name}`)).join(` ${t("common.and")} `);
}
