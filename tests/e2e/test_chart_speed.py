"""The angle history with as many points as there are at once can be moved along."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.speed import POINTS, SECONDS, open_long_history, pan_frame_rate, service_with_a_long_past
from tests.e2e.visitor import Visitor

pytestmark = pytest.mark.browser


def test_ten_thousand_points_are_moved_along(
    chromium: Browser, tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    with service_with_a_long_past(tmp_path) as url, Visitor.at_work(chromium, url) as visitor:
        visitor.sign_in()
        visitor.open("/devices/van-1")
        page = visitor.page
        open_long_history(page)
        shown = page.get_by_role("region", name="Angle history").get_by_role("status").first
        rate = pan_frame_rate(page)
        before = shown.text_content() or ""  # where it ends depends on how regular the frames were
        print(f"{POINTS:,} points: {rate:.0f} frames a second over {SECONDS:.0f} s of panning")
        record_property("pan_frames_per_second", round(rate, 1))
        page.mouse.wheel(-60, 0)
        expect(shown).not_to_have_text(before)
        earlier = shown.text_content() or ""
        page.get_by_role("button", name="Later").click()
        expect(shown).not_to_have_text(earlier)
        expect(page.get_by_text(re.compile(r"\d,\d{3} estimates loaded"))).to_be_visible()  # of the part it came to
