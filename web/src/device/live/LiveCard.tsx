import { CircleCheckBig, TriangleAlert } from "lucide-react";
import { useMay } from "../../api/session";
import type { Installation, Need } from "../../api/types";
import { useNow } from "../../components/RelativeTime";
import { Ring } from "../../components/Ring";
import { Notice } from "../../components/Tone";
import { percent } from "../../lib/format";
import { NEED_ICON, STAGE, stageWord } from "../../lib/stages";
import { t } from "../../text";
import { Figures } from "./Figures";
import { instruction } from "./instruction";
import { LevelStart } from "./LevelStart";
import { levelHelps } from "./level";
import css from "./live.module.css";
import { Stepper } from "./Stepper";
import { ageOf, silence } from "./silence";
import { type Trouble, troubles } from "./troubles";

/** The answer to "what now?", large enough to read at arm's length. */
export function LiveCard({ installation }: { installation: Installation }) {
  const { stage, last_data_at, data } = installation;
  const now = useNow();
  const installer = useMay("installer");
  const silent = last_data_at !== null && silence(ageOf(last_data_at, now)) !== "none";
  const { say, also } = instruction(installation, silent);
  return (
    <section className={`card ${css.card}`} data-stage={stage} aria-label={t("device.live.region")}>
      <Stepper stage={stage} />
      <div className={css.now}>
        <Progress installation={installation} />
        <p className={css.say}>{say}</p>
      </div>
      {also.length > 0 && <Needs needs={also} />}
      <Troubles found={troubles(installation, now)} />
      {last_data_at && <Figures data={data} at={last_data_at} now={now} />}
      {installer && levelHelps(installation) && <LevelStart id={installation.device_id} />}
      <p className="visually-hidden" role="status">
        {t("device.live.status", { stage: stageWord(stage), say })}
      </p>
    </section>
  );
}

function Progress({ installation: { stage, progress } }: { installation: Installation }) {
  return (
    <Ring value={progress} tone={STAGE[stage].tone} label={t("common.progress")}>
      {stage === "confirmed" ? <CircleCheckBig size={40} className={css.check} /> : percent(progress)}
    </Ring>
  );
}

function Needs({ needs }: { needs: readonly Need[] }) {
  return (
    <div className={css.needs}>
      <h2>{t("device.live.also")}</h2>
      <ul>
        {needs.map((need) => {
          const Icon = NEED_ICON[need];
          return (
            <li key={need}>
              <Icon size={20} aria-hidden />
              {t(`common.need.${need}`)}
            </li>
          );
        })}
      </ul>
    </div>
  );
}

function Troubles({ found }: { found: readonly Trouble[] }) {
  if (found.length === 0) return null;
  return (
    <ul className={css.troubles} aria-label={t("device.trouble.list")}>
      {found.map(({ title, remedy, tone }) => (
        <li key={remedy}>
          <Notice tone={tone} icon={TriangleAlert} title={title}>
            <p>{remedy}</p>
          </Notice>
        </li>
      ))}
    </ul>
  );
}
