import { Anchor, Button } from "@mantine/core";
import { Link } from "wouter";
import type { MotionEvent } from "../api/types";
import { ClockTime } from "../components/RelativeTime";
import { t } from "../text";
import { ICON, summary } from "./happenings";
import css from "./motion.module.css";

interface EventListProps {
  id: string;
  events: readonly MotionEvent[];
  /** there are older ones */
  more?: (() => void) | undefined;
  onShow: (event: MotionEvent) => void;
}

/** What happened, newest first; each leads to its moment, an impact to its own page too. */
export function EventList({ id, events, more, onShow }: EventListProps) {
  return (
    <>
      <ol className={css.events}>
        {events.map((event) => (
          <li key={event.id} data-grave={event.kind === "impact" || undefined}>
            <Row id={id} event={event} onShow={onShow} />
          </li>
        ))}
      </ol>
      {more && (
        <Button variant="subtle" mt="sm" onClick={more}>
          {t("motion.event.older")}
        </Button>
      )}
    </>
  );
}

function Row({ id, event, onShow }: Omit<EventListProps, "events" | "more"> & { event: MotionEvent }) {
  const Icon = ICON[event.kind];
  const what = t(`motion.kind.${event.kind}`);
  return (
    <>
      <button type="button" title={t("motion.event.show", { what })} onClick={() => onShow(event)}>
        <Icon size={20} aria-hidden />
        <span>
          <b>{what}</b> <ClockTime at={event.at} />
          <br />
          {summary(event)}
        </span>
      </button>
      <Anchor component={Link} href={`/devices/${encodeURIComponent(id)}/motion/${event.id}`}>
        {t("motion.event.open")}
      </Anchor>
    </>
  );
}
