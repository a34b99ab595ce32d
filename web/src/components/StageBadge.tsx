import type { Stage } from "../api/types";
import { STAGE } from "../lib/stages";
import { Bar, Pill } from "./Tone";

export function StageBadge({ stage }: { stage: Stage }) {
  const { word, tone, icon } = STAGE[stage];
  return (
    <Pill tone={tone} icon={icon}>
      {word}
    </Pill>
  );
}

export function Progress({ stage, progress }: { stage: Stage; progress: number }) {
  return <Bar value={progress} tone={STAGE[stage].tone} label="Progress of the calibration" />;
}
