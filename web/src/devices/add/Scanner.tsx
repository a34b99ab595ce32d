import { Button, Group, Stack } from "@mantine/core";
import { Camera, CameraOff, Keyboard, RotateCw, TriangleAlert } from "lucide-react";
import { type ChangeEvent, useRef, useState } from "react";
import { Notice } from "../../components/Tone";
import { listed } from "../../lib/format";
import { t } from "../../text";
import { readPhoto } from "./camera";
import { type Code, type Found, scannedId, type Unusable } from "./scannedId";
import css from "./scanner.module.css";
import { type CameraState, useCamera } from "./useCamera";

interface ScannerProps {
  onFound: (found: Found) => void;
  onType: () => void;
}

/** Looks for a device's id with the camera, or in a photo where there is no live camera; typing stays possible. */
export function Scanner({ onFound, onType }: ScannerProps) {
  const [unusable, setUnusable] = useState<Unusable | null>(null);
  const take = (code: Code) => {
    const scanned = scannedId(code, location.hostname);
    if (scanned.id === null) setUnusable(scanned);
    else onFound(scanned);
  };
  const { video, state, again } = useCamera(take);
  const isLive = state === "starting" || state === "on";
  return (
    <Stack>
      <div className={css.view} hidden={!isLive}>
        <video ref={video} muted playsInline aria-label={t("devices.scan.view")} />
        <i aria-hidden />
      </div>
      <CameraWords state={state} />
      {unusable && <Explanation scanned={unusable} />}
      <Photo onCode={take} />
      <Group grow preventGrowOverflow={false}>
        {!isLive && state !== "insecure" && (
          <Button variant="default" leftSection={<RotateCw size={18} aria-hidden />} onClick={again}>
            {t("devices.scan.again")}
          </Button>
        )}
        <Button variant="default" leftSection={<Keyboard size={18} aria-hidden />} onClick={onType} autoFocus>
          {t("devices.scan.type")}
        </Button>
      </Group>
    </Stack>
  );
}

function CameraWords({ state }: { state: CameraState }) {
  if (state === "starting") return <p className={css.aim}>{t("devices.scan.starting")}</p>;
  if (state === "on") return <p className={css.aim}>{t("devices.scan.aim")}</p>;
  return (
    <Notice tone="warn" icon={CameraOff} title={t(`devices.scan.trouble.${state}`)} role="status">
      <p>{t(`devices.scan.remedy.${state}`)}</p>
    </Notice>
  );
}

/** What the code says, and why that is no device id. */
function Explanation({ scanned: { text, reason, characters = [] } }: { scanned: Unusable }) {
  const named = characters.map((character) => (/\s/.test(character) ? t("devices.code.blank") : character));
  return (
    <Notice tone="warn" icon={TriangleAlert} title={t("devices.code.title")} role="status">
      <p>{t(`devices.code.${reason}`, { count: text.length, characters: listed([...new Set(named)]) })}</p>
      {text && <code className={css.text}>{text}</code>}
    </Notice>
  );
}

type PhotoState = "idle" | "reading" | "nothing" | "unreadable";

function Photo({ onCode }: { onCode: (code: Code) => void }) {
  const input = useRef<HTMLInputElement>(null);
  const [state, setState] = useState<PhotoState>("idle");
  const read = async ({ currentTarget }: ChangeEvent<HTMLInputElement>) => {
    const file = currentTarget.files?.[0];
    currentTarget.value = "";
    if (!file) return;
    setState("reading");
    const code = await readPhoto(file).catch(() => undefined);
    setState(code === undefined ? "unreadable" : code ? "idle" : "nothing");
    if (code) onCode(code);
  };
  return (
    <div className={css.photo}>
      <input ref={input} type="file" accept="image/*" capture="environment" hidden onChange={read} />
      <Button
        fullWidth
        variant="light"
        leftSection={<Camera size={20} aria-hidden />}
        loading={state === "reading"}
        onClick={() => input.current?.click()}
      >
        {t("devices.scan.photo")}
      </Button>
      <p>{t("devices.scan.photo_about")}</p>
      <p role="status">{state !== "idle" && t(PHOTO_WORDS[state])}</p>
    </div>
  );
}

const PHOTO_WORDS = {
  reading: "devices.scan.reading",
  nothing: "devices.scan.photo_nothing",
  unreadable: "devices.scan.photo_unreadable",
} as const;
