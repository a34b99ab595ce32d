"""Everything that is measured of the page: first visits, and how smoothly it moves."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import httpx
from playwright.sync_api import Browser, Page, expect

from benchmarks.page_study.loading import View, Visits, visits
from tests import drives, fleets
from tests.cli import livella
from tests.e2e.speed import open_long_history, pan_frame_rate, scroll_frame_rate, service_with_a_long_past
from tests.e2e.visitor import Visitor
from tests.service import ADMIN_KEY, Api

DEVICES = 10_000
DRIVEN = "driven"
VIEWS = (
    View("sign-in", "/", "input", signed_in=False),
    View("devices", "/devices", "[data-index] a"),
    View("a device", f"/devices/{DRIVEN}", "[aria-current=step]"),
    View("alerts", "/alerts", "main h1"),
    View("settings", "/settings", "main h2"),
)


class Frames(NamedTuple):
    """How smoothly something moves."""

    what: str
    wanted: float
    """frames a second"""
    rates: list[float]
    """frames a second, run by run"""


class Study(NamedTuple):
    """What was measured."""

    visits: list[Visits]
    frames: list[Frames]


def carry_out(browser: Browser, directory: Path, number: int) -> Study:
    """Measure everything, each view and each movement so many times."""
    found, scrolling = _in_a_large_fleet(browser, directory / "fleet", number)
    return Study(found, [scrolling, _moving_the_past(browser, directory / "past", number)])


def _in_a_large_fleet(browser: Browser, directory: Path, number: int) -> tuple[list[Visits], Frames]:
    fleets.make(directory / "data", DEVICES)
    with livella.serving(directory, LIVELLA_ADMIN_KEY=ADMIN_KEY) as (url, _):
        with httpx.Client(base_url=url, timeout=60.0) as client:
            Api(client).add_device(DRIVEN, name="Driven").send_all(drives.plain().chunks)
        state = _signed_in(browser, url)
        found = [visits(browser, url, state, view, number) for view in VIEWS]
        with Visitor.at_work(browser, url, storage_state=state) as visitor:
            visitor.open("/devices")
            visitor.see("Van 1")
            rates = [scroll_frame_rate(visitor.page) for _ in range(number)]
    return found, Frames(f"scrolling through {DEVICES:,} devices", 50.0, rates)


def _moving_the_past(browser: Browser, directory: Path, number: int) -> Frames:
    directory.mkdir()
    with service_with_a_long_past(directory) as url, Visitor.at_work(browser, url) as visitor:
        visitor.sign_in()
        visitor.open("/devices/van-1")
        open_long_history(visitor.page)
        return Frames("moving charts of 10,000 points", 50.0, _repeat(pan_frame_rate, visitor.page, number))


def _repeat(measure: Callable[[Page], float], page: Page, number: int) -> list[float]:
    return [measure(page) for _ in range(number)]


def _signed_in(browser: Browser, url: str) -> Any:
    """Sign in; give what the browser then knows."""
    with Visitor.at_work(browser, url) as visitor:
        visitor.sign_in()
        expect(visitor.page.get_by_role("banner")).to_contain_text("Live")
        return visitor.page.context.storage_state()
