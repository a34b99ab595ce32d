import { lazy, Suspense, useState } from "react";
import type { Quaternion } from "../../lib/rotation";
import { Drawings } from "./Drawings";
import css from "./picture.module.css";

const Scene3D = lazy(() => import("./Scene3D"));

/** The device in a car, to be turned by hand; three drawings where the browser cannot draw in 3D. */
export function Picture({ quaternion, text }: { quaternion: Quaternion; text: string }) {
  const [flat, setFlat] = useState(false);
  if (flat) {
    return (
      <div role="img" aria-label={text}>
        <Drawings quaternion={quaternion} />
      </div>
    );
  }
  return (
    <Suspense fallback={<div className={css.stage} aria-hidden />}>
      <Scene3D quaternion={quaternion} text={text} onUnable={() => setFlat(true)} />
    </Suspense>
  );
}
