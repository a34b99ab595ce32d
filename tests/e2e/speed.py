"""How quickly the page moves: frames counted while a list is scrolled, and while the charts of a long past are moved.

Only measures: what is quick enough depends on the machine.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx
import numpy as np
import sqlalchemy as sa
from playwright.sync_api import Page, expect

from api.services.history_rows import ROW, Rows
from core import quaternion
from storage.database import Database, WriteSession
from storage.models import devices, estimates, sessions
from tests.cli import livella
from tests.service import ADMIN_KEY, Api

STEP = 5.0
"""s between two estimates"""
CHUNK = 120
"""estimates of a chunk"""
POINTS = 10_000
"""estimates; the service gives no more at once"""
SECONDS = 3.0

PAN = """async ([chart, seconds]) => {
    const over = chart.querySelector(".u-over");
    const turn = (deltaX) => over.dispatchEvent(new WheelEvent("wheel", {deltaX, bubbles: true, cancelable: true}));
    const frame = () => new Promise(requestAnimationFrame);
    const begin = await frame();
    for (let frames = 1, now; ; frames++) {
        now = (await frame() - begin) / 1000;
        if (now >= seconds) return frames / now;
        turn(now > seconds / 4 && now < seconds * 3 / 4 ? 8 : -8);
    }
}"""
"""Earlier, later and back again, 8 pixels with each frame; gives frames a second."""

SCROLLING = """
seconds => new Promise(done => {
    const end = document.documentElement.scrollHeight - innerHeight;
    let frames = 0, began;
    function frame(now) {
        began ??= now;
        const part = (now - began) / (1000 * seconds);
        if (part >= 1) return done(frames / seconds);
        frames += 1;
        scrollTo(0, part * end);
        requestAnimationFrame(frame);
    }
    requestAnimationFrame(frame);
})
"""


@contextmanager
def service_with_a_long_past(directory: Path) -> Iterator[str]:
    """Serve a device `van-1` with a long history; give the address."""
    with livella.serving(directory, LIVELLA_ADMIN_KEY=ADMIN_KEY) as (url, _):
        with httpx.Client(base_url=url, timeout=60.0) as client:
            Api(client).add_device("van-1", name="Van 1")
        database = Database(f"sqlite:///{directory / 'data' / 'livella.db'}")
        with database.write() as tx:
            add_past(tx, datetime.now(UTC) - timedelta(seconds=STEP * POINTS))
        database.close()
        yield url


def add_past(tx: WriteSession, start: datetime) -> None:
    """Write a session without a stop, as noisy as real ones are."""
    device = tx.execute(sa.select(devices.c.pk)).scalar_one()
    added = {"device_pk": device, "name": "long", "next_seq": 0, "created_at": start, "started_at": start}
    session = tx.execute(sa.insert(sessions).returning(sessions.c.pk), **added).scalar_one()
    rows = history(POINTS)
    blocks = [rows[first : first + CHUNK] for first in range(0, rows.size, CHUNK)]
    tx.connection.execute(
        sa.insert(estimates),
        [
            {
                "device_pk": device,
                "session_pk": session,
                "t_first": float(block["t"][0]),
                "t_last": float(block["t"][-1]),
                "size": block.size,
                "changes": 0,
                "rows": block.tobytes(),
                "received_at": start + timedelta(seconds=float(block["t"][-1])),
            }
            for block in blocks
        ],
    )


def history(number: int) -> Rows:
    """Give angles that wander and tremble."""
    random = np.random.default_rng(1)
    rows = np.zeros(number, ROW)
    rows["t"] = STEP * np.arange(number)
    wander = np.cumsum(random.normal(0.0, 2e-4, (number, 3)), axis=0)
    angles = np.array([0.05, 0.14, -1.64]) + wander + random.normal(0.0, 2e-3, (number, 3))
    rows["quaternion"] = [quaternion.from_angles(*row) for row in angles]
    rows["sigma"], rows["progress"], rows["stage"] = 0.01, 1.0, 4
    rows["stable"] = rows["reliable"] = 1
    return rows


def open_long_history(page: Page) -> None:
    """Zoom into everything there is, with all of it loaded."""
    page.get_by_role("region", name="Angle history").scroll_into_view_if_needed()
    page.locator("label", has_text="Everything").click()
    page.get_by_role("button", name="Zoom in").click()
    expect(page.get_by_text(f"{POINTS:,} estimates loaded")).to_be_visible(timeout=30_000)


def pan_frame_rate(page: Page, seconds: float = SECONDS) -> float:
    """Move the angle history along with the wheel, at each frame, under the mouse; give frames a second."""
    chart = page.get_by_role("img", name="Yaw over time")
    chart.hover()
    rate: float = page.evaluate(PAN, [chart.element_handle(), seconds])
    return rate


def scroll_frame_rate(page: Page, seconds: float = 3.0) -> float:
    """Scroll the open page from top to end within so many seconds; give the frames drawn a second."""
    rate: float = page.evaluate(SCROLLING, seconds)
    return rate
