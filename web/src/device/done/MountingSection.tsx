import { CircleCheckBig, CircleDashed, Compass, TriangleAlert } from "lucide-react";
import { ClockTime } from "../../components/RelativeTime";
import { Section } from "../../components/Section";
import { Empty } from "../../components/States";
import { Pill } from "../../components/Tone";
import { fixed } from "../../lib/format";
import { describe, goodTo } from "../../lib/words";
import { Trans, t } from "../../text";
import { Picture } from "../picture/Picture";
import type { Shown } from "../shown";
import css from "./done.module.css";

/** How the device sits in the vehicle: in words and as a picture. */
export function MountingSection({ shown }: { shown: Shown | null }) {
  return (
    <Section title={t("device.mounting.title")} aside={shown && <Standing shown={shown} />}>
      {shown ? (
        <Found shown={shown} />
      ) : (
        <Empty icon={Compass} title={t("device.mounting.empty")}>
          {t("device.mounting.empty_do")}
        </Empty>
      )}
    </Section>
  );
}

function Standing({ shown: { mount } }: { shown: Shown }) {
  if (!mount)
    return (
      <Pill tone="neutral" icon={CircleDashed}>
        {t("device.mounting.so_far")}
      </Pill>
    );
  if (mount.status === "suspect")
    return (
      <Pill tone="bad" icon={TriangleAlert}>
        {t("device.mounting.suspect")}
      </Pill>
    );
  return (
    <Pill tone="good" icon={CircleCheckBig}>
      <span>
        <Trans
          i18nKey="device.mounting.confirmed"
          components={{ time: <ClockTime at={mount.confirmed_at} /> }}
        />
      </span>
    </Pill>
  );
}

function Found({ shown: { quaternion, angles, sigma } }: { shown: Shown }) {
  const words = describe(quaternion);
  return (
    <>
      <p className={css.words}>
        {words.turned} {goodTo(sigma)}
      </p>
      <p className={css.axesWords}>{words.axes}</p>
      <Picture quaternion={quaternion} text={`${words.turned} ${words.axes}`} />
      <dl className={css.angles}>
        <Angle word={t("common.roll")} axis="x" degrees={angles.roll} />
        <Angle word={t("common.pitch")} axis="y" degrees={angles.pitch} />
        <Angle word={t("common.yaw")} axis="z" degrees={angles.yaw} />
      </dl>
    </>
  );
}

function Angle({ word, axis, degrees }: { word: string; axis: "x" | "y" | "z"; degrees: number }) {
  return (
    <div style={{ "--angle": `var(--livella-${axis})` }}>
      <dt>{word}</dt>
      <dd>{fixed(degrees, 1)}°</dd>
    </div>
  );
}
