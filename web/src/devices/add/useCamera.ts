import { type RefObject, useCallback, useEffect, useRef, useState } from "react";
import { CameraTrouble, codeReader, openCamera, type Trouble, watch } from "./camera";
import type { Code } from "./scannedId";

export type CameraState = "starting" | "on" | Trouble;

interface Camera {
  video: RefObject<HTMLVideoElement | null>;
  state: CameraState;
  again: () => void;
}

/** The camera is on while this is on the screen, and off at once afterwards. */
export function useCamera(onCode: (code: Code) => void): Camera {
  const video = useRef<HTMLVideoElement>(null);
  const [state, setState] = useState<CameraState>("starting");
  const [tries, setTries] = useState(0);
  const told = useRef(onCode);
  told.current = onCode;
  // biome-ignore lint/correctness/useExhaustiveDependencies: another try is another run
  useEffect(() => {
    const stop = new AbortController();
    setState("starting");
    run(video, (code) => told.current(code), setState, stop.signal);
    return () => stop.abort();
  }, [tries]);
  return { video, state, again: useCallback(() => setTries((count) => count + 1), []) };
}

async function run(
  { current: video }: RefObject<HTMLVideoElement | null>,
  onCode: (code: Code) => void,
  onState: (state: CameraState) => void,
  signal: AbortSignal,
): Promise<void> {
  try {
    const stream = await openCamera();
    const close = () => stream.getTracks().forEach((track) => void track.stop());
    if (signal.aborted || !video) return close();
    signal.addEventListener("abort", close);
    video.srcObject = stream;
    await video.play();
    onState("on");
    await watch(video, await codeReader(), onCode, signal);
  } catch (error) {
    if (!signal.aborted) onState(error instanceof CameraTrouble ? error.trouble : "busy");
  }
}
