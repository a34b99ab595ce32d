import { CircleCheck } from "lucide-react";
import { useEffect, useSyncExternalStore } from "react";
import css from "./said.module.css";

/** ms for which it stays to be read */
const STAYS = 6000;

let said = "";
const listeners = new Set<() => void>();

/** Tell that something was done; the frame of the page shows it for a while, and screen readers say it. */
export function say(text: string): void {
  said = text;
  for (const listener of listeners) listener();
}

function subscribe(listener: () => void): () => void {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

export function Said() {
  const text = useSyncExternalStore(subscribe, () => said);
  useEffect(() => {
    if (text === "") return;
    const timer = setTimeout(() => say(""), STAYS);
    return () => clearTimeout(timer);
  }, [text]);
  return (
    <div role="status" className={`${css.said} no-print`}>
      {text && (
        <p>
          <CircleCheck size={20} aria-hidden />
          {text}
        </p>
      )}
    </div>
  );
}
