import { CircleCheckBig, CircleDashed, Compass, TriangleAlert } from "lucide-react";
import { ClockTime } from "../components/RelativeTime";
import { Section } from "../components/Section";
import { Empty } from "../components/States";
import { Pill } from "../components/Tone";
import { fixed } from "../lib/format";
import { describe } from "../lib/words";
import css from "./device.module.css";
import { Picture } from "./picture/Picture";
import type { Shown } from "./shown";

/** How the device sits in the vehicle: in words and as a picture. */
export function MountingSection({ shown }: { shown: Shown | null }) {
  return (
    <Section title="Mounting" aside={shown && <Standing shown={shown} />} className={css.mounting}>
      {shown ? (
        <Found shown={shown} />
      ) : (
        <Empty icon={Compass} title="Not known yet">
          Drive a little; it shows by itself.
        </Empty>
      )}
    </Section>
  );
}

function Standing({ shown: { mount } }: { shown: Shown }) {
  if (!mount)
    return (
      <Pill tone="neutral" icon={CircleDashed}>
        So far, not confirmed
      </Pill>
    );
  if (mount.status === "suspect")
    return (
      <Pill tone="bad" icon={TriangleAlert}>
        Suspect
      </Pill>
    );
  return (
    <Pill tone="good" icon={CircleCheckBig}>
      Confirmed <ClockTime at={mount.confirmed_at} />
    </Pill>
  );
}

function Found({ shown: { quaternion, angles } }: { shown: Shown }) {
  const words = describe(quaternion);
  return (
    <>
      <p className={css.words}>{words.turned}</p>
      <p className={css.axesWords}>{words.axes}</p>
      <Picture quaternion={quaternion} text={`${words.turned} ${words.axes}`} />
      <dl className={css.angles}>
        <Angle word="Roll" axis="x" degrees={angles.roll} />
        <Angle word="Pitch" axis="y" degrees={angles.pitch} />
        <Angle word="Yaw" axis="z" degrees={angles.yaw} />
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
