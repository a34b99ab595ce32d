import { memo } from "react";
import { whole } from "../lib/format";
import { t } from "../text";
import { type Drive, rowAt } from "./drive";
import type { Happening } from "./happenings";
import css from "./motion.module.css";
import { placeAt, type Track, trackOf } from "./track";

interface TrackMapProps {
  drive: Drive;
  row: number;
  happenings: readonly Happening[];
}

/** The way from above, north up, and where the vehicle was at the cursor. */
export function TrackMap({ drive, row, happenings }: TrackMapProps) {
  const track = trackOf(drive);
  if (!track) return <p className={css.quiet}>{t("motion.track.none")}</p>;
  const size = track.box[2];
  const here = placeAt(drive, row);
  return (
    <figure className={css.figure}>
      <svg
        viewBox={track.box.join(" ")}
        role="img"
        aria-label={t("motion.track.says", { metres: whole(size) })}
      >
        <Way track={track} />
        <Marks drive={drive} happenings={happenings} size={size} />
        {here && <Car place={here} heading={drive.heading[row] ?? null} size={size} />}
        <Scale track={track} />
      </svg>
      <figcaption>
        {t("motion.track.how")} {track.reckoned && t("motion.track.reckoned")}
      </figcaption>
    </figure>
  );
}

const Way = memo(function Way({ track }: { track: Track }) {
  const width = track.box[2] / 110;
  return (
    <g fill="none" strokeWidth={width} strokeLinejoin="round" strokeLinecap="round">
      <path className={css.way} d={track.measured} />
      <path className={css.reckoned} d={track.reckoned} strokeDasharray={`${2 * width} ${2.5 * width}`} />
    </g>
  );
});

function Marks({
  drive,
  happenings,
  size,
}: {
  drive: Drive;
  happenings: readonly Happening[];
  size: number;
}) {
  const [first, last] = [drive.time[0] ?? 0, drive.time.at(-1) ?? 0];
  return happenings
    .filter(({ time }) => time >= first && time <= last)
    .map(({ time, grave }) => {
      const place = placeAt(drive, rowAt(drive.time, time));
      if (!place) return null;
      return (
        <circle
          key={time}
          className={grave ? css.grave : css.usual}
          cx={place.x}
          cy={place.y}
          r={size / (grave ? 45 : 75)}
          strokeWidth={size / 200}
        />
      );
    });
}

/** An arrowhead in the direction of the vehicle; a dot where that is not known. */
function Car({
  place,
  heading,
  size,
}: {
  place: { x: number; y: number };
  heading: number | null;
  size: number;
}) {
  const unit = size / 28;
  if (heading === null) return <circle className={css.arrowhead} cx={place.x} cy={place.y} r={unit / 1.5} />;
  const turn = `translate(${place.x} ${place.y}) rotate(${heading}) scale(${unit})`;
  return <path className={css.arrowhead} d="M0 -1.2L.85 1L0 .5L-.85 1Z" transform={turn} />;
}

function Scale({ track: { box, scale } }: { track: Track }) {
  const [x, y, width, height] = box;
  const [left, low] = [x + width * 0.03, y + height * 0.97];
  return (
    <g className={css.scale} strokeWidth={width / 250} fontSize={width / 26}>
      <path d={`M${left} ${low - width / 60}V${low}H${left + scale}V${low - width / 60}`} />
      <text x={left + scale / 2} y={low - width / 60} textAnchor="middle">
        {scale >= 1000 ? `${whole(scale / 1000)} km` : `${whole(scale)} m`}
      </text>
    </g>
  );
}
