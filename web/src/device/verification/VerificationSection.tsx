import { CircleCheckBig, CircleX } from "lucide-react";
import { useMemo } from "react";
import type { Installation, Verification } from "../../api/types";
import { optional } from "../../components/optional";
import { Ring } from "../../components/Ring";
import { Section } from "../../components/Section";
import { Loading } from "../../components/States";
import { Pill } from "../../components/Tone";
import { WhenSeen } from "../../components/WhenSeen";
import { fixed } from "../../lib/format";
import { t } from "../../text";
import { countdown, kmh, speeds, spokenOf } from "./trace";
import css from "./verification.module.css";

const TraceLines = optional(() => import("./TraceLines"));

/** The drive test: how long it still takes, and how far the two speeds are apart. */
export function VerificationSection({ installation }: { installation: Installation }) {
  const test = spokenOf(installation);
  const drawn = useMemo(() => speeds(test.trace), [test.trace]);
  return (
    <Section title={t("device.test.title")} aside={<Verdict state={test.state} />}>
      <div className={css.test}>
        {test.state === "idle" && <Idle installation={installation} />}
        {test.state === "running" && <Left test={test} />}
        {test.state === "failed" && <p>{t("device.test.failed_why")}</p>}
        <SpeedError test={test} />
        {drawn && (
          <WhenSeen before={<Loading what={t("device.test.the_chart")} />}>
            <TraceLines speeds={drawn} />
          </WhenSeen>
        )}
      </div>
    </Section>
  );
}

function Verdict({ state }: { state: Verification["state"] }) {
  if (state === "passed")
    return (
      <Pill tone="good" icon={CircleCheckBig}>
        {t("device.test.passed")}
      </Pill>
    );
  if (state === "failed")
    return (
      <Pill tone="bad" icon={CircleX}>
        {t("device.test.failed")}
      </Pill>
    );
  return state === "running" ? <Pill tone="accent">{t("device.test.running")}</Pill> : null;
}

function Idle({ installation: { stage, verification } }: { installation: Installation }) {
  const seconds = fixed(verification.duration_s, 0);
  return (
    <p className={css.quiet}>
      {stage === "confirmed" ? t("device.test.none") : t("device.test.begins", { seconds })}
    </p>
  );
}

function Left({ test }: { test: Verification }) {
  const { left, share, goesOn } = countdown(test);
  const seconds = fixed(left, 0);
  return (
    <div className={css.left}>
      <Ring value={share} label={t("device.test.title")} text={t("device.test.left_says", { seconds })}>
        {seconds} s<small>{t("device.test.left_word")}</small>
      </Ring>
      <p>{goesOn ? t("device.test.goes_on", { seconds }) : t("device.test.how")}</p>
    </div>
  );
}

function SpeedError({ test: { state, error_mps, limit_mps } }: { test: Verification }) {
  if (state === "idle" || error_mps === null) return null;
  const within = Math.abs(error_mps) <= limit_mps;
  const Icon = within ? CircleCheckBig : CircleX;
  return (
    <p className={css.error} data-within={within}>
      <Icon size={18} aria-label={t(within ? "device.test.within" : "device.test.beyond")} />
      {t("device.test.error", { error: kmh(error_mps), limit: kmh(limit_mps) })}
    </p>
  );
}
