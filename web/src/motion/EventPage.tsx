import { Button } from "@mantine/core";
import { Download, Route } from "lucide-react";
import { useMemo } from "react";
import { Problem } from "../api/http";
import { useMotion, useMotionEvent } from "../api/motion";
import type { MotionEvent } from "../api/types";
import { NotFound } from "../app/NotFound";
import { useTitle } from "../app/title";
import { Section } from "../components/Section";
import { Empty, Failed, Loading } from "../components/States";
import { exactly } from "../lib/time";
import { t } from "../text";
import { driveOf } from "./drive";
import { Facts } from "./Facts";
import { happening, summary } from "./happenings";
import css from "./motion.module.css";
import { PageHead } from "./PageHead";
import { Pictures } from "./Pictures";
import { PushPicture } from "./PushPicture";

/** s before and after an event that are looked at */
const AROUND = 10;
/** Every sample of them, also of quick devices. */
const ROWS = 10_000;

/** One event: where the push came from, how hard it was, and the seconds around it. */
export function EventPage({ id, event }: { id: string; event: number }) {
  const read = useMotionEvent(id, event);
  useTitle(read.data ? t(`motion.kind.${read.data.kind}`) : t("motion.title"));
  const what = t("motion.the_event");
  if (read.error instanceof Problem && [403, 404, 422].includes(read.error.status)) {
    return <NotFound title={t("motion.event.gone")} />;
  }
  if (read.isPending) return <Loading what={what} lines={8} />;
  if (read.isError) return <Failed what={what} error={read.error} retry={read.refetch} />;
  return <Content id={id} event={read.data} />;
}

function Content({ id, event }: { id: string; event: MotionEvent }) {
  const device = `/devices/${encodeURIComponent(id)}`;
  return (
    <div className={css.page}>
      <PageHead
        back={`${device}/motion`}
        backTo={t("motion.title")}
        title={t(`motion.kind.${event.kind}`)}
        facts={`${id} · ${exactly(new Date(event.at))}`}
      />
      <Section title={t("motion.event.what")}>
        <p className={css.lead}>{summary(event)}</p>
        <div className={css.told}>
          {event.direction_deg !== null && <PushPicture direction={event.direction_deg} />}
          <Facts event={event} />
        </div>
      </Section>
      <Around id={id} event={event} />
    </div>
  );
}

function Around({ id, event }: { id: string; event: MotionEvent }) {
  const middle = Date.parse(event.at);
  const moment = (seconds: number) => new Date(middle + 1000 * seconds).toISOString();
  const range = { from: moment(-AROUND), to: moment(AROUND) };
  const motion = useMotion(id, range, ROWS);
  const drive = useMemo(() => motion.data && driveOf(motion.data), [motion.data]);
  const happenings = useMemo(() => [happening(event)], [event]);
  const what = t("motion.the_motion");
  return (
    <Section
      title={t("motion.event.around", { seconds: AROUND })}
      aside={<Take id={id} from={range.from} to={range.to} />}
    >
      {motion.isPending && <Loading what={what} lines={12} />}
      {motion.isError && <Failed what={what} error={motion.error} retry={motion.refetch} />}
      {drive?.time.length === 0 && (
        <Empty icon={Route} title={t("motion.nothing")}>
          {t("motion.no_raw")}
        </Empty>
      )}
      {drive && drive.time.length > 0 && (
        <Pictures drive={drive} happenings={happenings} begin={middle / 1000} />
      )}
    </Section>
  );
}

/** The readings themselves, for an expert's own tools. */
function Take({ id, from, to }: { id: string; from: string; to: string }) {
  const query = new URLSearchParams({ from, to, format: "csv" });
  return (
    <Button
      component="a"
      h={44}
      variant="default"
      leftSection={<Download size={18} aria-hidden />}
      href={`/api/v1/devices/${encodeURIComponent(id)}/raw?${query}`}
      download={`${id}.csv`}
    >
      {t("motion.event.raw")}
    </Button>
  );
}
