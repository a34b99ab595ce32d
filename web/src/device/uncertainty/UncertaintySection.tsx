import { ChartLine, Check } from "lucide-react";
import type { CSSProperties } from "react";
import type { Installation } from "../../api/types";
import { Section } from "../../components/Section";
import { Empty } from "../../components/States";
import { WhenSeen } from "../../components/WhenSeen";
import { degreesText } from "../../lib/format";
import { t } from "../../text";
import { shownMounting } from "../shown";
import { SigmaChart } from "./SigmaChart";
import { sigmaLimits, sigmaShare } from "./sigma";
import css from "./uncertainty.module.css";

/** One sigma of each rotation, now and as it shrank, against the limit it must be below. */
export function UncertaintySection({ installation }: { installation: Installation }) {
  const shown = shownMounting(installation);
  return (
    <Section title={t("device.sure.title")}>
      {shown ? (
        <>
          <Sigmas sigma={shown.sigma} limits={sigmaLimits(installation.limits)} />
          <WhenSeen before={null}>
            <SigmaChart installation={installation} />
          </WhenSeen>
          <p className={css.note}>{t("device.sure.note")}</p>
        </>
      ) : (
        <Empty icon={ChartLine} title={t("device.sure.empty")}>
          {t("device.sure.empty_do")}
        </Empty>
      )}
    </Section>
  );
}

interface SigmasProps {
  sigma: readonly number[];
  limits: readonly number[];
}

function Sigmas({ sigma, limits }: SigmasProps) {
  const axes = [
    { word: t("common.roll"), about: t("device.sure.about_x"), axis: "x" },
    { word: t("common.pitch"), about: t("device.sure.about_y"), axis: "y" },
    { word: t("common.yaw"), about: t("device.sure.about_z"), axis: "z" },
  ];
  return (
    <div className={css.sigmas}>
      {axes.map((axis, i) => (
        <Sigma key={axis.axis} {...axis} sigma={sigma[i] ?? Number.NaN} limit={limits[i] ?? Number.NaN} />
      ))}
    </div>
  );
}

interface SigmaProps {
  word: string;
  about: string;
  axis: string;
  sigma: number;
  limit: number;
}

function Sigma({ word, about, axis, sigma, limit }: SigmaProps) {
  const good = sigma <= limit;
  const place = {
    "--axis": `var(--livella-${axis})`,
    "--share": `${100 * sigmaShare(sigma)}%`,
    "--limit": `${100 * sigmaShare(limit)}%`,
  };
  return (
    <div className={css.sigma} data-good={good} style={place as CSSProperties}>
      <span title={about}>{word}</span>
      <b>
        {t("device.sure.plus_minus", { degrees: degreesText(sigma) })}
        {good ? <Check size={16} strokeWidth={3} aria-label={t("device.sure.below")} /> : <i aria-hidden />}
      </b>
      <div className={css.scale} aria-hidden>
        <i />
      </div>
    </div>
  );
}
