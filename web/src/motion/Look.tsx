import { ActionIcon, Button, SegmentedControl } from "@mantine/core";
import { ChevronLeft, ChevronRight, Route, SkipForward } from "lucide-react";
import { useMemo } from "react";
import { useMotion } from "../api/motion";
import type { Motion, MotionEvent } from "../api/types";
import { Section } from "../components/Section";
import { Empty, Failed, Loading } from "../components/States";
import { between } from "../lib/time";
import { t } from "../text";
import { driveOf } from "./drive";
import { happening } from "./happenings";
import css from "./motion.module.css";
import { Pictures } from "./Pictures";
import { LENGTH_TEXT, LENGTHS, type Length, moved, rangeOf, type View } from "./window";

interface LookProps {
  id: string;
  lastData: string | null;
  view: View;
  setView: (view: View) => void;
  events: readonly MotionEvent[];
}

/** One stretch of driving: which, and what it was like. */
export function Look({ id, lastData, view, setView, events }: LookProps) {
  const range = rangeOf(view, lastData);
  const motion = useMotion(id, range);
  const what = t("motion.the_motion");
  return (
    <Section title={t("motion.drive")} aside={<Lengths view={view} setView={setView} />}>
      <Moves view={view} setView={setView} lastData={lastData} />
      {range?.from && range.to && (
        <p role="status" className={css.shown}>
          {between(new Date(range.from), new Date(range.to))}
        </p>
      )}
      {range === null && <Nothing mount={null} />}
      {motion.isError && <Failed what={what} error={motion.error} retry={motion.refetch} />}
      {range !== null && motion.isPending && <Loading what={what} lines={12} />}
      {motion.data && <Shown motion={motion.data} events={events} />}
    </Section>
  );
}

function Shown({ motion, events }: { motion: Motion; events: readonly MotionEvent[] }) {
  const drive = useMemo(() => driveOf(motion), [motion]);
  const happenings = useMemo(() => events.map(happening), [events]);
  if (drive.time.length === 0) return <Nothing mount={motion.mount} />;
  return <Pictures drive={drive} happenings={happenings} />;
}

/** Without a mounting the readings have no direction; with one, they were not kept, or the vehicle did not run. */
function Nothing({ mount }: { mount: number | null }) {
  return (
    <Empty icon={Route} title={t("motion.nothing")}>
      {t(mount === null ? "motion.needs_mounting" : "motion.no_raw")}
    </Empty>
  );
}

function Lengths({ view, setView }: Pick<LookProps, "view" | "setView">) {
  const choose = (value: string) => setView({ ...view, length: Number(value) as Length });
  return (
    <SegmentedControl
      aria-label={t("motion.length")}
      data={LENGTHS.map((length) => ({ value: String(length), label: LENGTH_TEXT[length] }))}
      value={String(view.length)}
      onChange={choose}
    />
  );
}

function Moves({ view, setView, lastData }: Pick<LookProps, "view" | "setView" | "lastData">) {
  return (
    // biome-ignore lint/a11y/useSemanticElements: a fieldset would be a form's
    <div role="group" aria-label={t("motion.move.label")} className={css.moves}>
      <ActionIcon
        size={44}
        variant="default"
        aria-label={t("motion.move.earlier")}
        onClick={() => setView(moved(view, -1, lastData))}
      >
        <ChevronLeft size={20} aria-hidden />
      </ActionIcon>
      <ActionIcon
        size={44}
        variant="default"
        aria-label={t("motion.move.later")}
        disabled={view.end === null}
        onClick={() => setView(moved(view, 1, lastData))}
      >
        <ChevronRight size={20} aria-hidden />
      </ActionIcon>
      {view.end !== null && (
        <Button
          h={44}
          variant="light"
          leftSection={<SkipForward size={18} aria-hidden />}
          onClick={() => setView({ ...view, end: null })}
        >
          {t("motion.move.latest")}
        </Button>
      )}
    </div>
  );
}
