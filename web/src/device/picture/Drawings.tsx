import { deviceAxes, type Quaternion, type Vector } from "../../lib/rotation";
import { t } from "../../text";
import css from "./picture.module.css";
import { drawn, VIEWS, type View } from "./views";

const AXES = ["x", "y", "z"] as const;
/** Metres on the paper; the device is drawn larger than it is. */
const ARROW = 1.25;

/** The mounting in three drawings: for paper, and for screens without 3D. */
export function Drawings({ quaternion }: { quaternion: Quaternion }) {
  return (
    <div className={css.drawings}>
      {VIEWS.map((view) => (
        <Drawing key={view.name} view={view} axes={deviceAxes(quaternion)} />
      ))}
    </div>
  );
}

function Drawing({ view, axes }: { view: View; axes: readonly Vector[] }) {
  const arrows = AXES.map((name, i) => ({ name, ...drawn(view, axes[i] ?? [0, 0, 0]) })).sort(
    (a, b) => a.depth - b.depth,
  );
  return (
    <figure>
      <svg viewBox="-2.4 -2.4 4.8 4.8" aria-hidden="true">
        <path className={css.car} d={view.outline} transform="scale(1 -1)" />
        {arrows.map(({ name, right, up, depth, foreshortened }) => (
          <g key={name} style={{ color: `var(--livella-${name})` }}>
            {foreshortened ? (
              <PointingAtReader name={name} away={depth < 0} />
            ) : (
              <Arrow name={name} x={right * ARROW} y={-up * ARROW} />
            )}
          </g>
        ))}
      </svg>
      <figcaption>{t(`device.picture.from_${view.name}`)}</figcaption>
    </figure>
  );
}

function Arrow({ name, x, y }: { name: string; x: number; y: number }) {
  const angle = (Math.atan2(y, x) * 180) / Math.PI;
  const length = Math.hypot(x, y);
  const beyond = 1 + 0.28 / length;
  return (
    <>
      <path
        d={`M0 0H${length - 0.15}`}
        transform={`rotate(${angle})`}
        stroke="currentColor"
        strokeWidth={0.11}
      />
      <path d={`M${length} 0l-.32 -.16v.32z`} transform={`rotate(${angle})`} fill="currentColor" />
      <Label name={name} x={x * beyond} y={y * beyond} />
    </>
  );
}

/** The point of an arrow, or its feathers. */
function PointingAtReader({ name, away }: { name: string; away: boolean }) {
  return (
    <>
      <circle r={0.17} className={css.paper} stroke="currentColor" strokeWidth={0.07} />
      {away ? (
        <path d="M-.11 -.11l.22 .22M.11 -.11l-.22 .22" stroke="currentColor" strokeWidth={0.07} />
      ) : (
        <circle r={0.07} fill="currentColor" />
      )}
      <Label name={name} x={-0.32} y={0.32} />
    </>
  );
}

function Label({ name, x, y }: { name: string; x: number; y: number }) {
  return (
    <text x={x} y={y} fill="currentColor" className={css.label}>
      {name}
    </text>
  );
}
