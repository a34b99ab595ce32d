import { Problem } from "../api/http";
import { useMotionEvents } from "../api/motion";
import { useDevice, useInstallation } from "../api/queries";
import { useMay } from "../api/session";
import type { MotionEvent } from "../api/types";
import { NotFound } from "../app/NotFound";
import { useTitle } from "../app/title";
import { Section } from "../components/Section";
import { Failed, Loading } from "../components/States";
import { t } from "../text";
import { EventList } from "./EventList";
import { Look } from "./Look";
import css from "./motion.module.css";
import { PageHead } from "./PageHead";
import { useView } from "./useView";
import { around } from "./window";

/** How the vehicle moved, and what happened to it. */
export function MotionPage({ id }: { id: string }) {
  const device = useDevice(id, useMay("installer"));
  const installation = useInstallation(id);
  const name = device.data?.name ?? id;
  useTitle(t("motion.title_of", { name }));
  if (installation.error instanceof Problem && [403, 404].includes(installation.error.status)) {
    return <NotFound title={t("device.gone", { id })} />;
  }
  if (installation.isPending) return <Loading what={t("motion.the_motion")} lines={8} />;
  if (installation.isError) {
    return <Failed what={t("motion.the_motion")} error={installation.error} retry={installation.refetch} />;
  }
  return (
    <div className={css.page}>
      <PageHead
        back={`/devices/${encodeURIComponent(id)}`}
        backTo={name}
        title={t("motion.title")}
        facts={device.data?.vehicle ?? id}
      />
      <Content id={id} lastData={installation.data.last_data_at} />
    </div>
  );
}

function Content({ id, lastData }: { id: string; lastData: string | null }) {
  const [view, setView] = useView();
  const events = useMotionEvents(id);
  const known = events.data?.pages.flatMap(({ items }) => items) ?? [];
  const show = (event: MotionEvent) => {
    setView(around(Date.parse(event.at) / 1000));
    document.querySelector("main")?.scrollIntoView();
  };
  return (
    <>
      <Look id={id} lastData={lastData} view={view} setView={setView} events={known} />
      <Section title={t("motion.events")}>
        {events.isPending && <Loading what={t("motion.the_events")} />}
        {events.isError && (
          <Failed what={t("motion.the_events")} error={events.error} retry={events.refetch} />
        )}
        {events.data && known.length === 0 && <p className={css.quiet}>{t("motion.event.none")}</p>}
        <EventList
          id={id}
          events={known}
          more={events.hasNextPage ? () => events.fetchNextPage() : undefined}
          onShow={show}
        />
      </Section>
    </>
  );
}
