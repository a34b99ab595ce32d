/** Angles for charts: degrees that do not jump at +-180. */

/** The same direction in (-180, 180]. */
export function wrap(degrees: number): number {
  const turned = ((degrees % 360) + 360) % 360;
  return turned > 180 ? turned - 360 : turned;
}

/** Smallest signed turn from `from` to `to`, in (-180, 180]. */
export function turnBetween(from: number, to: number): number {
  return wrap(to - from);
}

/**
 * Add whole turns so that neighbours never differ by more than half a turn. Gaps (null) stay gaps, and the curve goes on
 * after them near where it stopped. The curve as a whole is placed so that its last value is in (-180, 180].
 */
export function unwrap(degrees: readonly (number | null)[]): (number | null)[] {
  let last: number | null = null;
  const continuous = degrees.map((value) => {
    if (value === null || !Number.isFinite(value)) return null;
    last = last === null ? value : last + turnBetween(last, value);
    return last;
  });
  const offset = last === null ? 0 : wrap(last) - last;
  return continuous.map((value) => (value === null ? null : value + offset));
}
