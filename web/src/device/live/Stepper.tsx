import { Check } from "lucide-react";
import type { Stage } from "../../api/types";
import { STAGES, stageMeaning, stageWord } from "../../lib/stages";
import { t } from "../../text";
import css from "./live.module.css";

/** The five stages in a row, with the present one marked. */
export function Stepper({ stage }: { stage: Stage }) {
  const now = STAGES.indexOf(stage);
  return (
    <ol className={css.steps} aria-label={t("device.live.stages")}>
      {STAGES.map((step, i) => {
        const done = i < now || (i === now && stage === "confirmed");
        const state = done ? "done" : i === now ? "current" : "ahead";
        return (
          <li key={step} data-state={state} aria-current={i === now ? "step" : undefined}>
            <i aria-hidden>{done ? <Check size={16} strokeWidth={3} /> : i + 1}</i>
            <span className={css.word} title={stageMeaning(step)}>
              {stageWord(step)}
            </span>
            <span className="visually-hidden">{t(`device.live.step.${state}`)}</span>
          </li>
        );
      })}
    </ol>
  );
}
