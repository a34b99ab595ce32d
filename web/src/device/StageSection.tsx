import { CircleCheckBig, TriangleAlert } from "lucide-react";
import { useMay } from "../api/session";
import type { Installation, Need, Verification } from "../api/types";
import { ClockTime } from "../components/RelativeTime";
import { Progress } from "../components/StageBadge";
import { Notice } from "../components/Tone";
import { NEED_ICON, stageWord } from "../lib/stages";
import { t } from "../text";
import { LevelStart } from "./LevelStart";
import { levelHelps } from "./level";
import { Stepper } from "./Stepper";
import css from "./stage.module.css";

/** The answer to "what now?", large enough to read at arm's length. */
export function StageSection({ installation }: { installation: Installation }) {
  const { stage, hint, needs, progress, mount, verification } = installation;
  const installer = useMay("installer");
  return (
    <section className={`card ${css.stage}`} data-stage={stage} aria-label="Stage of the calibration">
      <Stepper stage={stage} />
      <div className={css.now}>
        {stage === "confirmed" && <CircleCheckBig size={40} className={css.check} aria-hidden />}
        <p className={css.hint}>{hint}</p>
      </div>
      {verification.state === "running" && <Countdown verification={verification} />}
      {mount?.status === "suspect" && <Suspect since={mount.confirmed_at} />}
      {needs.length > 0 && <Needs needs={needs} />}
      {installer && levelHelps(installation) && <LevelStart id={installation.device_id} />}
      <div className={css.progress}>
        <Progress stage={stage} progress={progress} />
        <span aria-hidden>{Math.round(progress * 100)} %</span>
      </div>
      <p className="visually-hidden" role="status">
        Stage: {stageWord(stage)}. {hint}
      </p>
    </section>
  );
}

function Countdown({ verification: { elapsed_s, duration_s } }: { verification: Verification }) {
  return (
    <p className={css.countdown}>
      Drive test:{" "}
      <b>
        {Math.floor(Math.min(elapsed_s, duration_s))} of {Math.round(duration_s)} s
      </b>
    </p>
  );
}

function Suspect({ since }: { since: string }) {
  return (
    <Notice tone="bad" icon={TriangleAlert} title="The device seems to have moved">
      <p>
        The mounting confirmed on <ClockTime at={since} /> is kept but no longer trusted until a new one is
        confirmed.
      </p>
    </Notice>
  );
}

function Needs({ needs }: { needs: readonly Need[] }) {
  return (
    <div className={css.needs}>
      <h2>Still needed</h2>
      <ul>
        {needs.map((need) => {
          const Icon = NEED_ICON[need];
          return (
            <li key={need}>
              <Icon size={22} aria-hidden />
              {t(`common.need.${need}`)}
            </li>
          );
        })}
      </ul>
    </div>
  );
}
