/** The camera that looks away from the person, and reading codes in what it sees. */
import type { BarcodeDetector as Detector } from "qr/decode.js";
import type { Code } from "./scannedId";

export type Trouble = "refused" | "none" | "busy" | "insecure";
export type Read = (picture: ImageBitmapSource) => Promise<Code | null>;

declare global {
  /** Where the browser has it; it reads barcodes too. */
  var BarcodeDetector: ((new (options: DetectorOptions) => Detector) & typeof Detector) | undefined;
}
type DetectorOptions = ConstructorParameters<typeof Detector>[0];

const FORMATS = [
  "qr_code",
  "data_matrix",
  "code_128",
  "code_39",
  "ean_13",
  "ean_8",
  "upc_a",
  "upc_e",
] as const;
/** ms between two looks: the camera's picture stays fluent, and the phone cool */
const PAUSE = 120;
/** px; enough for any label, and few enough to be quick */
const PHOTO_SIDES = [2000, 1000];

/** What reads codes in pictures: the browser's own means, or else those that read QR codes only. */
export async function codeReader(): Promise<Read> {
  const native = globalThis.BarcodeDetector;
  const able = native ? await native.getSupportedFormats() : [];
  const formats = FORMATS.filter((format) => able.includes(format));
  const own = native && formats.length > 0 ? new native({ formats }) : undefined;
  const detector = own ?? new (await import("qr/decode.js")).BarcodeDetector({ formats: ["qr_code"] });
  return async (picture) => {
    const [found] = await detector.detect(picture).catch(() => []);
    return found ? { text: found.rawValue, format: found.format } : null;
  };
}

/** Open the camera; throws a `CameraTrouble`. */
export async function openCamera(): Promise<MediaStream> {
  if (!navigator.mediaDevices) throw new CameraTrouble(isSecureContext ? "none" : "insecure");
  try {
    const video = { facingMode: "environment", width: { ideal: 1280 }, height: { ideal: 960 } };
    return await navigator.mediaDevices.getUserMedia({ video, audio: false });
  } catch (error) {
    throw new CameraTrouble(troubleOf(error));
  }
}

export class CameraTrouble extends Error {
  constructor(readonly trouble: Trouble) {
    super(trouble);
  }
}

function troubleOf(error: unknown): Trouble {
  const name = error instanceof DOMException ? error.name : "";
  if (name === "NotAllowedError" || name === "SecurityError") return "refused";
  return name === "NotFoundError" || name === "OverconstrainedError" ? "none" : "busy";
}

/** Look at what the camera shows until told to stop; tells of every code it sees. */
export async function watch(
  video: HTMLVideoElement,
  read: Read,
  onCode: (code: Code) => void,
  signal: AbortSignal,
): Promise<void> {
  while (!signal.aborted) {
    const code = video.readyState >= HTMLMediaElement.HAVE_CURRENT_DATA ? await read(video) : null;
    if (code && !signal.aborted) onCode(code);
    await new Promise((done) => setTimeout(done, PAUSE));
  }
}

/** Read a code in a photo; null when none is found. Throws when the file is no picture. */
export async function readPhoto(file: Blob): Promise<Code | null> {
  const [picture, read] = await Promise.all([createImageBitmap(file), codeReader()]);
  for (const side of PHOTO_SIDES) {
    const code = await read(await shrunk(picture, side));
    if (code) return code;
  }
  return null;
}

async function shrunk(picture: ImageBitmap, side: number): Promise<ImageBitmap> {
  const scale = side / Math.max(picture.width, picture.height);
  if (scale >= 1) return picture;
  return createImageBitmap(picture, {
    resizeWidth: Math.round(picture.width * scale),
    resizeHeight: Math.round(picture.height * scale),
    resizeQuality: "high",
  });
}
