import { fixed } from "../../lib/format";
import { t } from "../../text";
import { apart } from "../apart";
import { type Speeds, speedsSay } from "../verification/trace";
import css from "./certificate.module.css";
import { type Frame, frame, line } from "./drawing";

/** The two speeds of a drive test, for paper: it needs no script when it is printed. */
export function SpeedDrawing({ speeds }: { speeds: Speeds }) {
  const { time, gps, sensor } = speeds;
  const drawn = frame(time.at(-1) ?? 1, Math.max(...gps, ...sensor));
  const ends = [gps, sensor].map((column) => drawn.y(column.at(-1) ?? 0));
  const [gpsName = 0, sensorName = 0] = apart(ends, 4, drawn.bottom);
  return (
    <svg className={css.speeds} viewBox={drawn.viewBox} role="img" aria-label={speedsSay(speeds)}>
      <Grid drawn={drawn} />
      <path d={line(drawn, time, gps)} stroke="#0b6e93" />
      <path d={line(drawn, time, sensor)} stroke="#8f4a00" strokeDasharray="2.4 1.4" />
      <text x={drawn.right + 1.5} y={gpsName} fill="#0b6e93">
        {t("device.test.gps")}
      </text>
      <text x={drawn.right + 1.5} y={sensorName} fill="#8f4a00">
        {t("device.test.sensor")}
      </text>
    </svg>
  );
}

function Grid({ drawn }: { drawn: Frame }) {
  return (
    <g className={css.grid}>
      {drawn.speeds.map((speed) => (
        <g key={speed}>
          <path d={`M${drawn.left} ${drawn.y(speed)}H${drawn.right}`} />
          <text x={drawn.left - 1.5} y={drawn.y(speed)} textAnchor="end">
            {fixed(speed, 0)}
          </text>
        </g>
      ))}
      {drawn.times.map((second) => (
        <text key={second} x={drawn.x(second)} y={drawn.bottom + 3} textAnchor="middle">
          {fixed(second, 0)} s
        </text>
      ))}
      <text x={0} y={2} textAnchor="start">
        {t("device.test.axis")}
      </text>
    </g>
  );
}
