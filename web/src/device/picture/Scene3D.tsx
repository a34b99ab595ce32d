import { SegmentedControl, useComputedColorScheme } from "@mantine/core";
import { useReducedMotion } from "@mantine/hooks";
import { type KeyboardEvent, useEffect, useRef, useState } from "react";
import type { Quaternion } from "../../lib/rotation";
import { t } from "../../text";
import { mountedDevice, type Palette, tiltedCar } from "./car";
import css from "./picture.module.css";
import { CarScene, type ViewName } from "./scene";

const VIEWS: readonly ViewName[] = ["corner", "above", "left", "behind"];
/** Turns of the camera about the vehicle, degrees to its left and up. */
const KEYS: Record<string, readonly [number, number]> = {
  ArrowLeft: [15, 0],
  ArrowRight: [-15, 0],
  ArrowUp: [0, 15],
  ArrowDown: [0, -15],
};

const SHOWN = { device: mountedDevice, tilt: tiltedCar };

export interface SceneProps {
  quaternion: Quaternion;
  text: string;
  /** the device in its car, or the car on level ground; the device turns slowly */
  shows: keyof typeof SHOWN;
  /** no WebGL here */
  onUnable: () => void;
}

export default function Scene3D({ quaternion, text, shows, onUnable }: SceneProps) {
  const host = useRef<HTMLDivElement>(null);
  const scene = useRef<CarScene>(null);
  const [view, setView] = useState<ViewName | "">("corner");
  const scheme = useComputedColorScheme("light");
  const still = useReducedMotion();
  const latest = useRef({ quaternion, view, onUnable });
  latest.current = { quaternion, view, onUnable };

  // biome-ignore lint/correctness/useExhaustiveDependencies: the colours are read again when the scheme changes
  useEffect(() => {
    if (!host.current) return;
    try {
      scene.current = new CarScene(host.current, palette(host.current), SHOWN[shows], still, () =>
        setView(""),
      );
    } catch {
      latest.current.onUnable();
      return;
    }
    scene.current.turn(latest.current.quaternion, false);
    scene.current.look(latest.current.view || "corner");
    return () => scene.current?.dispose();
  }, [scheme, still, shows]);

  useEffect(() => scene.current?.turn(quaternion, shows === "device"), [quaternion, shows]);

  const choose = (chosen: ViewName) => {
    setView(chosen);
    scene.current?.look(chosen);
  };
  const press = (event: KeyboardEvent) => {
    const turn = KEYS[event.key];
    if (!turn) return;
    event.preventDefault();
    scene.current?.orbit(...turn);
  };
  return (
    <>
      {/* biome-ignore lint/a11y/useSemanticElements: a fieldset is for forms */}
      <div
        className={css.stage}
        role="group"
        // biome-ignore lint/a11y/noNoninteractiveTabindex: the arrow keys turn what is in it
        tabIndex={0}
        aria-label={t(shows === "device" ? "device.picture.about" : "motion.attitude.about")}
        onKeyDown={press}
      >
        <div ref={host} role="img" aria-label={text} />
      </div>
      <SegmentedControl
        aria-label={t("device.picture.views")}
        fullWidth
        data={VIEWS.map((value) => ({ value, label: t(`device.picture.${value}`) }))}
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
