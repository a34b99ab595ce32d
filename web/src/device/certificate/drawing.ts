/** Places on a drawing of speed over time, in millimetres of paper. */

const WIDTH = 178;
const HEIGHT = 40;
const EDGE = { left: 10, right: 18, top: 5, bottom: 5 };

export interface Frame {
  viewBox: string;
  left: number;
  right: number;
  bottom: number;
  /** s -> mm */
  x: (seconds: number) => number;
  /** km/h -> mm */
  y: (speed: number) => number;
  /** what is written at the axes: s and km/h */
  times: number[];
  speeds: number[];
}

/** A frame that holds so many seconds and speeds from standstill to `most` km/h. */
export function frame(seconds: number, most: number): Frame {
  const step = [5, 10, 20, 50].find((width) => most / width <= 4) ?? 100;
  const top = step * Math.max(1, Math.ceil(most / step));
  const [right, bottom] = [WIDTH - EDGE.right, HEIGHT - EDGE.bottom];
  return {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
    left: EDGE.left,
    right,
    bottom,
    x: (second) => EDGE.left + ((right - EDGE.left) * second) / seconds,
    y: (speed) => bottom - ((bottom - EDGE.top) * speed) / top,
    times: ticks(seconds, seconds > 60 ? 20 : 10),
    speeds: ticks(top, step),
  };
}

function ticks(end: number, step: number): number[] {
  return Array.from({ length: Math.floor(end / step + 1e-9) + 1 }, (_, i) => i * step);
}

export function line({ x, y }: Frame, time: readonly number[], speed: readonly number[]): string {
  const points = time.map((second, i) => `${x(second).toFixed(2)} ${y(speed[i] ?? 0).toFixed(2)}`);
  return `M${points.join("L")}`;
}
