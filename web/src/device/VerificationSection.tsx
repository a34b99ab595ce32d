import { CircleCheckBig, CircleX } from "lucide-react";
import type { Stage, Verification } from "../api/types";
import { Section } from "../components/Section";
import { Bar, Pill } from "../components/Tone";
import css from "./device.module.css";

interface VerificationProps {
  verification: Verification;
  stage: Stage;
}

/** The drive test: how long it has run, and how far the forward acceleration and the GPS speed are apart. */
export function VerificationSection({ verification, stage }: VerificationProps) {
  const { state, elapsed_s, duration_s } = verification;
  const elapsed = Math.min(elapsed_s, duration_s);
  return (
    <Section title="Drive test" aside={<Verdict state={state} />}>
      {state === "idle" ? (
        <p className={css.quiet}>
          {stage === "confirmed"
            ? "No test is running."
            : `Starts by itself once the angles have settled, and takes ${Math.round(duration_s)} s of driving.`}
        </p>
      ) : (
        <>
          <Measure
            label={state === "running" ? "Driven" : "Driving tested"}
            value={`${Math.floor(elapsed)} of ${Math.round(duration_s)} s`}
            share={elapsed / duration_s}
            tone="accent"
          />
          <SpeedError verification={verification} />
        </>
      )}
    </Section>
  );
}

function Verdict({ state }: { state: Verification["state"] }) {
  if (state === "passed")
    return (
      <Pill tone="good" icon={CircleCheckBig}>
        Passed
      </Pill>
    );
  if (state === "failed")
    return (
      <Pill tone="bad" icon={CircleX}>
        Failed
      </Pill>
    );
  return state === "running" ? <Pill tone="accent">Running</Pill> : null;
}

function SpeedError({ verification: { error_mps, limit_mps } }: { verification: Verification }) {
  if (error_mps === null) return null;
  const size = Math.abs(error_mps);
  return (
    <Measure
      label="Speed error"
      value={`${size.toFixed(1)} m/s, limit ${limit_mps.toFixed(1)}`}
      share={size / limit_mps}
      tone={size <= limit_mps ? "good" : "bad"}
    />
  );
}

interface MeasureProps {
  label: string;
  value: string;
  share: number;
  tone: "accent" | "good" | "bad";
}

function Measure({ label, value, share, tone }: MeasureProps) {
  return (
    <div className={css.measure}>
      <span>{label}</span>
      <b>{value}</b>
      <Bar value={share} label={label} text={value} tone={tone} />
    </div>
  );
}
