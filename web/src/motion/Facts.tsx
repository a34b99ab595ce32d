import type { MotionEvent } from "../api/types";
import { fixed } from "../lib/format";
import { t } from "../text";
import { inG, inKmh, lasting } from "./happenings";
import css from "./motion.module.css";

/** The figures of an event; what is not known is left out. */
export function Facts({ event }: { event: MotionEvent }) {
  return (
    <dl className={css.facts}>
      {rows(event).map(([label, text]) => (
        <div key={label}>
          <dt>{label}</dt>
          <dd>{text}</dd>
        </div>
      ))}
    </dl>
  );
}

function rows(event: MotionEvent): [string, string][] {
  const { peak_mps2, duration_s, direction_deg, speed_change_mps, speed_mps, mount, session } = event;
  const [forward = 0, left = 0] = speed_change_mps;
  const found: [string, string][] = [
    [t("motion.fact.peak"), `${inG(peak_mps2)} (${fixed(peak_mps2, 1)} m/s²)`],
    [t("motion.fact.duration"), lasting(duration_s)],
  ];
  if (direction_deg !== null) {
    found.push([t("motion.fact.forward"), inKmh(forward)], [t("motion.fact.left"), inKmh(left)]);
  }
  if (speed_mps !== null) found.push([t("motion.fact.speed"), inKmh(speed_mps)]);
  found.push(
    [t("motion.fact.mount"), t("motion.fact.mount_number", { number: mount })],
    [t("motion.fact.session"), session],
  );
  return found;
}
