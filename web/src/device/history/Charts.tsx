import { useMediaQuery } from "@mantine/hooks";
import type { CSSProperties } from "react";
import { whole } from "../../lib/format";
import { t } from "../../text";
import { AngleChart } from "./AngleChart";
import { MARK_LOOK } from "./drawMarks";
import { ANGLES, type AngleHistory } from "./history";
import css from "./history.module.css";
import { MARK_KINDS, type Mark, type MarkKind } from "./marks";
import type { HistoryWindow } from "./useWindow";

interface ChartsProps {
  history: AngleHistory;
  marks: readonly Mark[];
  window: HistoryWindow;
  /** estimates that are loaded */
  points: number;
}

export function Charts({ history, marks, window: { time, view, reset }, points }: ChartsProps) {
  const touched = useMediaQuery("(pointer: coarse)");
  return (
    <div className={css.charts}>
      {ANGLES.map((angle) => (
        <AngleChart
          key={angle}
          angle={angle}
          history={history}
          marks={marks}
          time={time}
          view={view}
          first={angle === ANGLES[0]}
          last={angle === ANGLES.at(-1)}
          onReset={reset}
        />
      ))}
      <Legend kinds={MARK_KINDS.filter((kind) => marks.some((mark) => mark.kind === kind))} />
      <div className={css.note}>
        <p>{t("history.points", { count: points, number: whole(points) })}</p>
        <p>{t("history.band")}</p>
        <p>{t(touched ? "history.how_touch" : "history.how_mouse")}</p>
      </div>
    </div>
  );
}

function Legend({ kinds }: { kinds: readonly MarkKind[] }) {
  if (kinds.length === 0) return null;
  return (
    <ul className={css.legend} aria-label={t("history.legend.label")}>
      {kinds.map((kind) => (
        <li key={kind}>
          <Line kind={kind} /> {t(`history.legend.${kind}`)}
        </li>
      ))}
    </ul>
  );
}

/** A piece of the line that marks such an event. */
export function Line({ kind }: { kind: MarkKind }) {
  const { colour, dash, width } = MARK_LOOK[kind];
  return (
    <svg
      className={css.line}
      width="6"
      height="18"
      aria-hidden
      style={{ "--mark": `var(${colour})` } as CSSProperties}
    >
      <line
        x1="3"
        x2="3"
        y1="0"
        y2="18"
        strokeWidth={width + 0.5}
        strokeDasharray={dash.join(" ") || undefined}
      />
    </svg>
  );
}
