import { whole } from "../../lib/format";
import { onTheClock } from "../../lib/time";
import { t } from "../../text";
import fold from "../fold.module.css";
import { Line } from "./Charts";
import css from "./history.module.css";
import { type Mark, within } from "./marks";
import { centred, lengthOf, type Span } from "./span";
import type { TimeAxis } from "./timeAxis";

/** A longer list nobody reads; zooming in shortens it. */
const MOST = 100;
/** s; an event is shown with at most so much around it */
const AROUND = 1200;

interface EventsProps {
  marks: readonly Mark[];
  span: Span | null;
  time: TimeAxis;
}

/** The marks as a list, newest first; each leads to its place in the charts. */
export function Events({ marks, span, time }: EventsProps) {
  const seen = span ? within(marks, span).reverse() : [];
  if (marks.length === 0) return null;
  const number = whole(seen.length);
  return (
    <details className={css.events}>
      <summary className={fold.line}>
        {seen.length > MOST
          ? t("history.event.list_cut", { number, most: whole(MOST) })
          : t("history.event.list", { number })}
      </summary>
      <ol>
        {seen.slice(0, MOST).map((mark) => (
          <li key={`${mark.kind} ${mark.time} ${mark.text}`}>
            <button
              type="button"
              title={t("history.event.show", { what: mark.text })}
              onClick={() => show(time, mark)}
            >
              <Line kind={mark.kind} />
              <span className={css.event}>
                <time dateTime={new Date(mark.time * 1000).toISOString()}>
                  {onTheClock(new Date(mark.time * 1000))}
                </time>
                <span>{mark.text}</span>
              </span>
            </button>
          </li>
        ))}
      </ol>
    </details>
  );
}

/** Where everything is shown, look closer. */
function show(time: TimeAxis, { time: moment }: Mark): void {
  const span = time.span;
  if (!span) return;
  const half = Math.min(lengthOf(span) * (time.chosen ? 1 : 0.25), AROUND) / 2;
  time.look(centred({ min: -half, max: half }, moment));
}
