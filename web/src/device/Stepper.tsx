import { Check } from "lucide-react";
import type { Stage } from "../api/types";
import { STAGES, stageMeaning, stageWord } from "../lib/stages";
import css from "./stage.module.css";

type State = "done" | "current" | "ahead";
const SAID: Record<State, string> = { done: " (done)", current: " (now)", ahead: " (not yet)" };

/** The five stages in a row, with the present one marked. */
export function Stepper({ stage }: { stage: Stage }) {
  const now = STAGES.indexOf(stage);
  return (
    <ol className={css.steps} aria-label="Stages">
      {STAGES.map((step, i) => {
        const done = i < now || (i === now && stage === "confirmed");
        const state: State = done ? "done" : i === now ? "current" : "ahead";
        return (
          <li key={step} data-state={state} aria-current={i === now ? "step" : undefined}>
            <i aria-hidden>{done ? <Check size={16} strokeWidth={3} /> : i + 1}</i>
            <span className={css.word} title={stageMeaning(step)}>
              {stageWord(step)}
            </span>
            <span className="visually-hidden">{SAID[state]}</span>
          </li>
        );
      })}
    </ol>
  );
}
