"""First visits: what a browser loads, and how long it takes until the page can be used."""

from collections.abc import Sequence
from statistics import median
from typing import Any, NamedTuple

from playwright.sync_api import Browser, Page, ViewportSize

SLOW_DOWN = 4
"""times slower than the machine's processor"""
PHONE: ViewportSize = {"width": 360, "height": 740}
APART = "Scene3D"
"""script that is not counted: the 3D part, which comes where it is shown, after the rest"""
QUIET = 2000.0
"""ms after the view can be used in which what comes late is still counted"""
WATCH = """selector => {
    window.usable = new Promise(resolve => {
        const look = () => {
            if (!document.querySelector(selector)) return;
            watcher.disconnect();
            requestAnimationFrame(() => setTimeout(() => resolve(performance.now()), 0));
        };
        const watcher = new MutationObserver(look);
        watcher.observe(document, {childList: true, subtree: true});
    });
}"""
"""Tells the ms since the visit began at which what is looked for is there and has been painted."""


class View(NamedTuple):
    """A page as somebody opens it."""

    name: str
    path: str
    selector: str
    """what must be there for it to be of use"""
    signed_in: bool = True


class Visit(NamedTuple):
    """A first visit, nothing kept from an earlier one."""

    script: int
    """bytes of JavaScript that came over the network, compressed"""
    usable: float
    """s"""


class Visits(NamedTuple):
    """Several of them."""

    view: View
    script: float
    """kB, the most"""
    usable: float
    """s, in the median"""
    slowest: float
    """s"""


def visits(browser: Browser, url: str, state: Any, view: View, number: int) -> Visits:
    """Visit a view so many times."""
    made = [visit(browser, url, state, view) for _ in range(number)]
    times = [one.usable for one in made]
    return Visits(view, max(one.script for one in made) / 1000, median(times), max(times))


def visit(browser: Browser, url: str, state: Any, view: View) -> Visit:
    """Visit a view with an empty cache and a slow processor; `state` is that of somebody signed in."""
    context = browser.new_context(viewport=PHONE, storage_state=state if view.signed_in else None)
    page = context.new_page()
    session = context.new_cdp_session(page)
    session.send("Network.enable")
    session.send("Emulation.setCPUThrottlingRate", {"rate": SLOW_DOWN})
    scripts = _Scripts()
    session.on("Network.responseReceived", scripts.began)
    session.on("Network.loadingFinished", scripts.ended)
    page.add_init_script(f"({WATCH})({view.selector!r})")
    page.goto(url + view.path, wait_until="commit")
    usable = _usable(page)
    page.wait_for_timeout(QUIET)
    context.close()
    return Visit(scripts.size(), usable / 1000)


def _usable(page: Page) -> float:
    found: float = page.evaluate("window.usable")
    return found


class _Scripts:
    """Scripts on their way."""

    def __init__(self) -> None:
        self._names: dict[str, str] = {}
        self._heads: dict[str, int] = {}
        self._sizes: dict[str, int] = {}

    def began(self, event: dict[str, Any]) -> None:
        """An answer begins."""
        url = event["response"]["url"]
        if url.split("?")[0].endswith(".js"):
            self._names[event["requestId"]] = url
            self._heads[event["requestId"]] = int(event["response"]["encodedDataLength"])

    def ended(self, event: dict[str, Any]) -> None:
        """An answer has come."""
        number = event["requestId"]
        self._sizes[number] = int(event["encodedDataLength"]) - self._heads.get(number, 0)

    def size(self) -> int:
        """Give the bytes of all but the 3D part."""
        return sum(self._sizes.get(number, 0) for number, name in self._names.items() if APART not in name)


def largest(found: Sequence[Visits]) -> float:
    """Give the most JavaScript of any view, kB."""
    return max(one.script for one in found)
