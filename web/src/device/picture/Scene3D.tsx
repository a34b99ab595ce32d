import { SegmentedControl, useComputedColorScheme } from "@mantine/core";
import { useReducedMotion } from "@mantine/hooks";
import { useEffect, useRef, useState } from "react";
import type { Quaternion } from "../../lib/rotation";
import type { Palette } from "./car";
import css from "./picture.module.css";
import { CarScene, type ViewName } from "./scene";

const VIEWS: readonly { value: ViewName; label: string }[] = [
  { value: "corner", label: "Corner" },
  { value: "above", label: "Above" },
  { value: "left", label: "Left" },
  { value: "behind", label: "Behind" },
];

export interface SceneProps {
  quaternion: Quaternion;
  text: string;
  /** no WebGL here */
  onUnable: () => void;
}

export default function Scene3D({ quaternion, text, onUnable }: SceneProps) {
  const host = useRef<HTMLDivElement>(null);
  const scene = useRef<CarScene>(null);
  const [view, setView] = useState<ViewName>("corner");
  const scheme = useComputedColorScheme("light");
  const still = useReducedMotion();
  const latest = useRef({ quaternion, view, onUnable });
  latest.current = { quaternion, view, onUnable };

  // biome-ignore lint/correctness/useExhaustiveDependencies: the colours are read again when the scheme changes
  useEffect(() => {
    if (!host.current) return;
    try {
      scene.current = new CarScene(host.current, palette(host.current), still);
    } catch {
      latest.current.onUnable();
      return;
    }
    scene.current.turn(latest.current.quaternion, false);
    scene.current.look(latest.current.view);
    return () => scene.current?.dispose();
  }, [scheme, still]);

  useEffect(() => scene.current?.turn(quaternion, true), [quaternion]);

  const choose = (chosen: ViewName) => {
    setView(chosen);
    scene.current?.look(chosen);
  };
  return (
    <>
      <div ref={host} className={css.stage} role="img" aria-label={text} />
      <SegmentedControl
        aria-label="View of the vehicle"
        fullWidth
        data={[...VIEWS]}
        value={view}
        onChange={(value) => choose(value as ViewName)}
      />
    </>
  );
}

function palette(element: HTMLElement): Palette {
  const style = getComputedStyle(element);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  return {
    car: colour("--livella-car"),
    line: colour("--livella-line"),
    tyre: colour("--livella-tyre"),
    ink: colour("--mantine-color-text"),
    box: colour("--livella-accent"),
    axes: [colour("--livella-x"), colour("--livella-y"), colour("--livella-z")],
  };
}
