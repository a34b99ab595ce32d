import { SegmentedControl } from "@mantine/core";
import { type ComponentType, lazy, Suspense, useState } from "react";
import type { SceneProps } from "../device/picture/Scene3D";
import { fixed } from "../lib/format";
import { t } from "../text";
import { type Drive, tilt } from "./drive";
import css from "./motion.module.css";

/** Three.js is large: it comes only with the picture; the numbers beside it say the same. */
const Scene3D = lazy<ComponentType<SceneProps>>(() =>
  import("../device/picture/Scene3D").catch(() => ({ default: () => null })),
);

const TIMES = [1, 5] as const;

/** The vehicle as it stood at the cursor: its tilt, which on the road is small, can be drawn larger. */
export function AttitudePicture({ drive, row }: { drive: Drive; row: number }) {
  const [times, setTimes] = useState<number>(5);
  const [flat, setFlat] = useState(false);
  const angles = anglesAt(drive, row);
  return (
    <figure className={css.figure}>
      {!flat && (
        <Suspense fallback={<div className={css.stage} aria-hidden />}>
          <Scene3D
            shows="tilt"
            quaternion={tilt(drive, row, times)}
            text={t("motion.attitude.says", angles)}
            onUnable={() => setFlat(true)}
          />
        </Suspense>
      )}
      <figcaption className={css.angles}>
        <span>{t("motion.attitude.roll", angles)}</span>
        <span>{t("motion.attitude.pitch", angles)}</span>
        <span>{t("motion.attitude.heading", angles)}</span>
      </figcaption>
      {!flat && (
        <SegmentedControl
          aria-label={t("motion.attitude.scale")}
          fullWidth
          data={TIMES.map((n) => ({ value: String(n), label: t(`motion.attitude.times_${n}`) }))}
          value={String(times)}
          onChange={(value) => setTimes(Number(value))}
        />
      )}
    </figure>
  );
}

function anglesAt({ roll, pitch, heading }: Drive, row: number) {
  const text = (value: number | null | undefined, digits: number) =>
    value == null ? "–" : `${fixed(value, digits)}°`;
  return { roll: text(roll[row], 1), pitch: text(pitch[row], 1), heading: text(heading[row], 0) };
}
