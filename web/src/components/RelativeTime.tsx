import { useSyncExternalStore } from "react";
import { ago, onTheClock } from "../lib/time";

let now = new Date();
const listeners = new Set<() => void>();
let timer: ReturnType<typeof setInterval> | undefined;

function tick(): void {
  now = new Date();
  for (const listener of listeners) listener();
}

/** One clock for the whole page, running only while somebody looks at it. */
function subscribe(listener: () => void): () => void {
  listeners.add(listener);
  if (timer === undefined) {
    now = new Date();
    timer = setInterval(tick, 1000);
  }
  return () => {
    listeners.delete(listener);
    if (listeners.size > 0) return;
    clearInterval(timer);
    timer = undefined;
  };
}

const present = () => now;

/** The time to the second, for what has to stay true while it is on the screen. */
export function useNow(): Date {
  return useSyncExternalStore(subscribe, present, present);
}

/** "12 seconds ago", kept true while it is on the screen; the full time on hover. */
export function RelativeTime({ at }: { at: string }) {
  const current = useNow();
  const time = new Date(at);
  return (
    <time dateTime={at} title={onTheClock(time)}>
      {ago(time, current)}
    </time>
  );
}

export function ClockTime({ at }: { at: string }) {
  return <time dateTime={at}>{onTheClock(new Date(at))}</time>;
}
