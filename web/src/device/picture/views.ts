/** Three drawings of the vehicle, as an engineer would make them: what a direction in the vehicle looks like in each. */
import type { Vector } from "../../lib/rotation";
import { dot } from "../../lib/rotation";

export interface View {
  name: "above" | "left" | "behind";
  /** vehicle directions that are right and up on the paper */
  right: Vector;
  up: Vector;
  /** vehicle direction from the paper to the reader */
  toward: Vector;
  /** outline of a car, metres, in the paper's right and up */
  outline: string;
}

const WHEELS =
  "M-1.4 -.35a.33 .33 0 1 0 .66 0a.33 .33 0 1 0 -.66 0M1.2 -.35a.33 .33 0 1 0 .66 0a.33 .33 0 1 0 -.66 0";

export const VIEWS: readonly View[] = [
  {
    name: "above",
    right: [0, -1, 0],
    up: [1, 0, 0],
    toward: [0, 0, 1],
    outline:
      "M-.85 1.6Q-.8 2.2 0 2.2T.85 1.6V-1.7Q.8 -2.15 0 -2.15T-.85 -1.7ZM-.68 1Q0 1.25 .68 1L.6 .45H-.6ZM-.62 -1.1H.62L.68 -1.6Q0 -1.75 -.68 -1.6Z",
  },
  {
    name: "left",
    right: [-1, 0, 0],
    up: [0, 0, 1],
    toward: [0, 1, 0],
    outline: `M-2.2 -.3V.1Q-2.1 .3 -1.1 .38L-.35 .9H1.1Q1.7 .8 2 .4L2.15 .3V-.3ZM-.75 .38L-.25 .78H.35V.38ZM.5 .38V.78H1.05Q1.4 .7 1.6 .38Z${WHEELS}`,
  },
  {
    name: "behind",
    right: [0, -1, 0],
    up: [0, 0, 1],
    toward: [-1, 0, 0],
    outline:
      "M-.88 -.35V.3L-.62 .9H.62L.88 .3V-.35ZM-.66 .36L-.5 .76H.5L.66 .36ZM-.82 -.35V-.68H-.5V-.35M.82 -.35V-.68H.5V-.35",
  },
];

export interface Drawn {
  right: number;
  up: number;
  /** positive: points at the reader */
  depth: number;
  /** shorter than an arrow can be drawn: it points at the reader or away */
  foreshortened: boolean;
}

const SHORTEST = 0.22;

/** A direction of the vehicle on the paper. */
export function drawn(view: View, direction: Vector): Drawn {
  const right = dot(view.right, direction);
  const up = dot(view.up, direction);
  return { right, up, depth: dot(view.toward, direction), foreshortened: Math.hypot(right, up) < SHORTEST };
}
