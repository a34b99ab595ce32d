import { Check } from "lucide-react";
import type { CSSProperties } from "react";
import type { Installation } from "../api/types";
import { Section } from "../components/Section";
import css from "./device.module.css";
import type { Shown } from "./shown";
import { sigmaLimits, sigmaShare } from "./sigma";

const AXES = [
  { word: "Roll", about: "about the forward axis" },
  { word: "Pitch", about: "about the left axis" },
  { word: "Yaw", about: "about the vertical axis" },
] as const;

interface UncertaintyProps {
  shown: Shown | null;
  limits: Installation["limits"];
}

/** One sigma of each rotation, against the limit it must be below. */
export function UncertaintySection({ shown, limits }: UncertaintyProps) {
  const marks = sigmaLimits(limits);
  return (
    <Section title="How sure">
      {shown ? (
        <div className={css.sigmas}>
          {AXES.map((axis, i) => (
            <Sigma
              key={axis.word}
              {...axis}
              sigma={shown.sigma[i] ?? Number.NaN}
              limit={marks[i] ?? Number.NaN}
            />
          ))}
          <p className={css.note}>One standard deviation. The marks are what the drive test needs.</p>
        </div>
      ) : (
        <p className={css.quiet}>Nothing is known yet.</p>
      )}
    </Section>
  );
}

function Sigma({ word, about, sigma, limit }: { word: string; about: string; sigma: number; limit: number }) {
  const good = sigma <= limit;
  const place = { "--share": `${100 * sigmaShare(sigma)}%`, "--limit": `${100 * sigmaShare(limit)}%` };
  return (
    <div className={css.sigma} data-good={good} style={place as CSSProperties}>
      <span title={about}>{word}</span>
      <b>
        ± {sigma.toFixed(sigma < 10 ? 1 : 0)}°
        {good ? <Check size={16} strokeWidth={3} aria-label="below the limit" /> : <i aria-hidden />}
      </b>
      <div className={css.scale} aria-hidden>
        <i />
      </div>
    </div>
  );
}
