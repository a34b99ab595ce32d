import { type ComponentType, lazy, Suspense, useEffect, useState } from "react";
import type { Quaternion } from "../../lib/rotation";
import { Drawings } from "./Drawings";
import css from "./picture.module.css";
import type { SceneProps } from "./Scene3D";

/** Three.js is large: it comes only with the picture, and where it does not come the drawings do. */
const Scene3D = lazy<ComponentType<SceneProps>>(() => import("./Scene3D").catch(() => ({ default: Unable })));

function Unable({ onUnable }: SceneProps) {
  useEffect(onUnable, [onUnable]);
  return null;
}

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
      <Scene3D shows="device" quaternion={quaternion} text={text} onUnable={() => setFlat(true)} />
    </Suspense>
  );
}
