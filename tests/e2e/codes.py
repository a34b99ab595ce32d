"""QR codes as pictures: drawn for the page's camera to see, and read from its screen, by the page's own library."""

import json
import struct
import subprocess
import zlib
from base64 import b64encode
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Locator

from tests.server import ROOT

Picture = NDArray[np.uint8]
WIDTH, HEIGHT = 640, 480
GREY, WHITE, BLACK = 128, 255, 0
MODULE = 8
"""px"""
DRAW = """
import { encodeQR } from "qr";
const text = JSON.parse(await new Response(process.stdin).text());
console.log(JSON.stringify(encodeQR(text, "raw", { border: 4 })));
"""
READ = """
import decodeQR from "qr/decode.js";
const { width, height, data } = JSON.parse(await new Response(process.stdin).text());
console.log(JSON.stringify(decodeQR({ width, height, data: new Uint8Array(Buffer.from(data, "base64")) })));
"""
PIXELS = """
async png => {
    const picture = new Image();
    picture.src = "data:image/png;base64," + png;
    await picture.decode();
    const canvas = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
    canvas.drawImage(picture, 0, 0);
    const { width, height, data } = canvas.getImageData(0, 0, picture.width, picture.height);
    return { width, height, data: btoa(data.reduce((text, byte) => text + String.fromCharCode(byte), "")) };
}
"""


def _node(script: str, given: Any) -> Any:
    done = subprocess.run(
        ["node", "--input-type=module", "--eval", script],
        input=json.dumps(given),
        cwd=ROOT / "web",
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def picture(text: str | None) -> Picture:
    """What a camera sees of a label with this text, or of no label."""
    seen = np.full((HEIGHT, WIDTH), GREY, np.uint8)
    if text is not None:
        code = np.kron(np.where(_node(DRAW, text), BLACK, WHITE), np.ones((MODULE, MODULE))).astype(np.uint8)
        top, left = (HEIGHT - code.shape[0]) // 2, (WIDTH - code.shape[1]) // 2
        seen[top : top + code.shape[0], left : left + code.shape[1]] = code
    return seen


def film(path: Path, seen: Picture) -> Path:
    """Store a film of one picture, as Chromium's made-up camera takes it."""
    colourless = bytes([GREY]) * (WIDTH * HEIGHT // 2)
    path.write_bytes(
        b"YUV4MPEG2 W%d H%d F30:1 Ip A1:1 C420jpeg\nFRAME\n" % (WIDTH, HEIGHT) + seen.tobytes() + colourless
    )
    return path


def png(seen: Picture) -> bytes:
    """Give a photo."""
    lines = b"".join(b"\0" + line.tobytes() for line in seen)
    head = struct.pack(">2I5B", WIDTH, HEIGHT, 8, 0, 0, 0, 0)
    parts = [(b"IHDR", head), (b"IDAT", zlib.compress(lines)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(map(_png_part, parts))


def _png_part(part: tuple[bytes, bytes]) -> bytes:
    name, data = part
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def read(shown: Locator) -> str:
    """Read the code that is shown, as a camera before the screen would."""
    shot = b64encode(shown.screenshot()).decode()
    text: str = _node(READ, shown.page.evaluate(PIXELS, shot))
    return text
