/**
 * Rotations as the service states them: q_vs scalar first, f_v = R(q_vs) f_s, vehicle x forward, y left, z up.
 * Angles are intrinsic z-y'-x'' (ISO 8855), in degrees: yaw positive to the left, pitch positive nose down, roll positive
 * right side down.
 */
export type Vector = readonly [number, number, number];
export type Quaternion = readonly [number, number, number, number];
export type Matrix = readonly [Vector, Vector, Vector];

export interface Angles {
  roll: number;
  pitch: number;
  yaw: number;
}

export const DEGREES = 180 / Math.PI;

/** Near this pitch (degrees) roll and yaw are no longer told apart in practice. */
export const GIMBAL_PITCH = 85;

/** Take a quaternion out of a JSON array, scaled to unit length. Throws when the array is none. */
export function toQuaternion(values: readonly number[]): Quaternion {
  const [w, x, y, z] = values;
  const norm = Math.hypot(...values);
  if (w === undefined || x === undefined || y === undefined || z === undefined || !(norm > 0)) {
    throw new RangeError(`not a quaternion: [${values.join(", ")}]`);
  }
  return [w / norm, x / norm, y / norm, z / norm];
}

/** R(q), row by row. */
export function matrix([w, x, y, z]: Quaternion): Matrix {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
}

/** Directions of the device's x, y and z axes in the vehicle: the columns of R(q_vs). */
export function deviceAxes(q: Quaternion): Matrix {
  const [a, b, c] = matrix(q);
  return [
    [a[0], b[0], c[0]],
    [a[1], b[1], c[1]],
    [a[2], b[2], c[2]],
  ];
}

/** Roll, pitch and yaw of a mounting. */
export function angles(q: Quaternion): Angles {
  const r = matrix(q);
  const cosine = Math.hypot(r[0][0], r[1][0]);
  const pitch = Math.atan2(-r[2][0], cosine) * DEGREES;
  if (cosine < 1e-6) return { roll: 0, pitch, yaw: Math.atan2(-r[0][1], r[1][1]) * DEGREES };
  return {
    roll: Math.atan2(r[2][1], r[2][2]) * DEGREES,
    pitch,
    yaw: Math.atan2(r[1][0], r[0][0]) * DEGREES,
  };
}

/** Mounting of the given angles in degrees: R = Rz(yaw) Ry(pitch) Rx(roll). */
export function fromAngles({ roll, pitch, yaw }: Angles): Quaternion {
  const [cr, sr] = halfAngle(roll);
  const [cp, sp] = halfAngle(pitch);
  const [cy, sy] = halfAngle(yaw);
  return [
    cy * cp * cr + sy * sp * sr,
    cy * cp * sr - sy * sp * cr,
    cy * sp * cr + sy * cp * sr,
    sy * cp * cr - cy * sp * sr,
  ];
}

function halfAngle(degrees: number): [number, number] {
  const half = degrees / DEGREES / 2;
  return [Math.cos(half), Math.sin(half)];
}

export function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
