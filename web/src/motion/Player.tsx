import { ActionIcon } from "@mantine/core";
import { Pause, Play } from "lucide-react";
import { useEffect, useState } from "react";
import { toTheSecond } from "../lib/time";
import { t } from "../text";
import { rowAt } from "./drive";
import css from "./motion.module.css";

/** ms between two pictures: smooth enough, and light on a phone */
const STEP = 100;

interface PlayerProps {
  time: readonly number[];
  row: number;
  onRow: (row: number) => void;
}

/** Drives the page's moment along, by hand or as fast as it was driven. */
export function Player({ time, row, onRow }: PlayerProps) {
  const [playing, setPlaying] = useState(false);
  const last = time.length - 1;

  useEffect(() => {
    if (!playing) return;
    if (row >= last) {
      setPlaying(false);
      return;
    }
    const now = time[row] ?? 0;
    const next = Math.max(rowAt(time, now + STEP / 1000), row + 1);
    const wait = Math.max(((time[next] ?? now) - now) * 1000, STEP);
    const timer = setTimeout(() => onRow(next), wait);
    return () => clearTimeout(timer);
  }, [playing, row, last, time, onRow]);

  const start = () => {
    if (row >= last) onRow(0);
    setPlaying(!playing);
  };
  return (
    <div className={css.player}>
      <ActionIcon
        size={44}
        variant="light"
        aria-label={t(playing ? "motion.pause" : "motion.play")}
        onClick={start}
      >
        {playing ? <Pause size={22} aria-hidden /> : <Play size={22} aria-hidden />}
      </ActionIcon>
      <input
        type="range"
        min={0}
        max={Math.max(last, 0)}
        value={row}
        aria-label={t("motion.moment")}
        aria-valuetext={clock(time[row])}
        onChange={(event) => onRow(Number(event.currentTarget.value))}
      />
      <output>{clock(time[row])}</output>
    </div>
  );
}

function clock(seconds: number | undefined): string {
  return seconds === undefined ? "–" : toTheSecond(new Date(seconds * 1000));
}
