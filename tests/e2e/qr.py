"""Reading QR codes off the screen, as a phone's camera does."""

import io
import json
import subprocess

from PIL import Image
from playwright.sync_api import Locator

from tests.server import ROOT

SCRIPT = """
import decodeQR from "qr/decode.js";
const [width, height] = JSON.parse(process.argv[1]);
const chunks = [];
for await (const chunk of process.stdin) chunks.push(chunk);
process.stdout.write(decodeQR({ width, height, data: new Uint8Array(Buffer.concat(chunks)) }));
"""


def read_code(shown: Locator) -> str:
    """Give the text of the code that an element shows."""
    picture = Image.open(io.BytesIO(shown.screenshot())).convert("RGBA")
    done = subprocess.run(
        ["node", "--input-type=module", "--eval", SCRIPT, json.dumps(picture.size)],
        input=picture.tobytes(),
        capture_output=True,
        cwd=ROOT / "web",
        timeout=60,
        check=True,
    )
    return done.stdout.decode()
