import type { Stage } from "../api/types";
import { STAGE, stageWord } from "../lib/stages";
import { t } from "../text";
import { Bar, Pill } from "./Tone";

export function StageBadge({ stage }: { stage: Stage }) {
  const { tone, icon } = STAGE[stage];
  return (
    <Pill tone={tone} icon={icon}>
      {stageWord(stage)}
    </Pill>
  );
}

export function Progress({ stage, progress }: { stage: Stage; progress: number }) {
  return <Bar value={progress} tone={STAGE[stage].tone} label={t("common.progress")} />;
}
