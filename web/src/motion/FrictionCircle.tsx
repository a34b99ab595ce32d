import { memo } from "react";
import { fixed } from "../lib/format";
import { t } from "../text";
import { dotAt, dotsOf, rings, sizeOf } from "./circle";
import type { Drive } from "./drive";
import css from "./motion.module.css";

interface FrictionCircleProps {
  drive: Drive;
  row: number;
}

/** Acceleration on the plan, forward up and to the right on the right; the row at the cursor is marked. */
export function FrictionCircle({ drive, row }: FrictionCircleProps) {
  const dots = dotsOf(drive);
  const drawn = rings(dots);
  const size = (drawn.at(-1) ?? 1) * 1.12;
  const here = dotAt(drive, row);
  const most = Math.max(0, ...dots.map(sizeOf));
  return (
    <figure className={css.figure}>
      <svg
        viewBox={`${-size} ${-size} ${2 * size} ${2 * size}`}
        role="img"
        aria-label={t("motion.circle.says", { most: fixed(most, 2) })}
      >
        <Rings drawn={drawn} size={size} />
        <Dots drive={drive} size={size} />
        {here && <circle className={css.here} cx={here.right} cy={-here.up} r={size / 28} />}
      </svg>
      <figcaption>{t("motion.circle.how")}</figcaption>
    </figure>
  );
}

function Rings({ drawn, size }: { drawn: readonly number[]; size: number }) {
  return (
    <g className={css.rings} strokeWidth={size / 200} fontSize={size / 13}>
      {drawn.map((ring) => (
        <g key={ring}>
          <circle r={ring} />
          <text x={size / 60} y={-ring - size / 60}>
            {`${fixed(ring, ring < 1 ? 1 : 0)} g`}
          </text>
        </g>
      ))}
      <path d={`M${-size} 0H${size}M0 ${-size}V${size}`} />
    </g>
  );
}

const Dots = memo(function Dots({ drive, size }: { drive: Drive; size: number }) {
  const path = dotsOf(drive)
    .map(({ right, up }) => `M${right.toFixed(3)} ${(-up).toFixed(3)}h0`)
    .join("");
  return <path className={css.dots} d={path} strokeWidth={size / 45} />;
});
