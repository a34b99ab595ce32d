import decodeQR from "qr/decode.js";
import { expect, it } from "vitest";
import { type QrDrawing, qrDrawing } from "./qr";

/** Pixels a module. */
const SCALE = 4;

/** Paint a drawing as a screen would. */
function painted({ side, path }: QrDrawing) {
  const width = side * SCALE;
  const data = new Uint8Array(width * width * 4).fill(255);
  const bars = [...path.matchAll(/M(\d+) (\d+)h(\d+)v1h-\d+z/g)].map((bar) => bar.slice(1).map(Number));
  for (const [x = 0, y = 0, length = 0] of bars) {
    for (let row = y * SCALE; row < (y + 1) * SCALE; row++) {
      for (let column = x * SCALE; column < (x + length) * SCALE; column++) {
        data.fill(0, 4 * (row * width + column), 4 * (row * width + column) + 3);
      }
    }
  }
  return { width, height: width, data };
}

it.each(["livella_Zx81", "https://fleet.example/devices/van-12", "è".repeat(200)])(
  "can be read: %s",
  (text) => expect(decodeQR(painted(qrDrawing(text)))).toBe(text),
);
