import { VIEWS } from "../device/picture/views";
import { fixed } from "../lib/format";
import { t } from "../text";
import css from "./motion.module.css";
import { fromWhere, oClock, origin } from "./push";

const CAR = VIEWS[0]?.outline ?? "";
/** Metres on the paper: where the arrow begins and ends, from the middle of the vehicle. */
const [FAR, NEAR] = [3.6, 1.9];

/** The vehicle from above, front up, and the push that it got; the sector is how well its direction is known. */
export function PushPicture({ direction }: { direction: number }) {
  const { x, y } = origin(direction);
  const degrees = fixed(Math.abs(direction), 0);
  const side = direction >= 0 ? "left" : "right";
  return (
    <figure className={css.push}>
      <svg
        viewBox="-4 -4 8 8"
        role="img"
        aria-label={t("motion.push.says", { side: fromWhere(direction), hour: oClock(direction) })}
      >
        <path className={css.car} d={CAR} transform="scale(1 -1)" />
        <g className={css.arrow}>
          <path d={`M${x * FAR} ${y * FAR}L${x * (NEAR + 0.5)} ${y * (NEAR + 0.5)}`} />
          <path
            d="M0 0L-.45 -.8H.45Z"
            transform={`translate(${x * NEAR} ${y * NEAR}) rotate(${-direction})`}
          />
        </g>
        <text className={css.front} y={-3.55} textAnchor="middle">
          {t("motion.push.front")}
        </text>
      </svg>
      <figcaption>{t(`motion.push.${side}_of_front`, { degrees, hour: oClock(direction) })}</figcaption>
    </figure>
  );
}
