"""Somebody looking at the page: sees what is on it, and whether the browser complains."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import Browser, ConsoleMessage, Page, Request, expect

from tests.server import ROOT
from tests.service import ADMIN_KEY

SWITCHES = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
PICTURES = ROOT / "out" / "screenshots"
AXE = ROOT / "web/node_modules/axe-core/axe.min.js"
STANDARD = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
EXPECTED = ("401 (Unauthorized)",)
"""Asking who is signed in, before anybody is, is answered so; every browser logs it."""


class Visitor:
    """A page of a browser, and everything it complained about or asked of other places."""

    def __init__(self, page: Page, address: str) -> None:
        self.page = page
        self.address = address
        self.complaints: list[str] = []
        self.elsewhere: list[str] = []
        self.tolerated: tuple[str, ...] = EXPECTED
        self.loads = 0
        page.on("console", self._listen)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", self._watch)

    @classmethod
    @contextmanager
    def at_work(
        cls, browser: Browser, address: str, width: int = 1280, height: int = 900, **options: Any
    ) -> Iterator["Visitor"]:
        """Look at the page for a while; at the end nothing may be wrong with it."""
        context = browser.new_context(
            viewport={"width": width, "height": height}, reduced_motion="reduce", timezone_id="Europe/Rome", **options
        )
        visitor = cls(context.new_page(), address)
        yield visitor
        context.close()
        assert not visitor.complaints, visitor.complaints
        assert not visitor.elsewhere, visitor.elsewhere

    def _listen(self, message: ConsoleMessage) -> None:
        text = f"{message.text} ({message.location['url']})"
        if message.type == "error" and not any(words in text for words in self.tolerated):
            self.complaints.append(text)

    def _watch(self, request: Request) -> None:
        self.loads += request.is_navigation_request()
        if not request.url.startswith((self.address, "data:", "blob:")):
            self.elsewhere.append(request.url)

    def open(self, path: str = "/") -> None:
        self.page.goto(self.address + path)

    def sign_in(self, key: str = ADMIN_KEY) -> None:
        self.open()
        self.page.get_by_role("textbox", name="Key").fill(key)
        self.page.get_by_role("button", name="Sign in").click()
        expect(self.page.get_by_role("banner")).to_contain_text("Live")

    def see(self, text: str, seconds: float = 10.0) -> None:
        """Wait until a text is on the page."""
        expect(self.page.get_by_text(text).first).to_be_visible(timeout=seconds * 1000)

    def scroll_to(self, section: str) -> None:
        """Bring a section into sight: some come only then."""
        self.page.get_by_role("region", name=section).scroll_into_view_if_needed()

    def see_stage(self, word: str, seconds: float = 10.0) -> None:
        """Wait until a stage is the present one."""
        expect(self.page.locator("[aria-current=step]")).to_contain_text(word, timeout=seconds * 1000)

    def picture(self, name: str) -> None:
        """Keep what is to be seen, from top to bottom; nothing may stick out sideways."""
        self.assert_fits()
        PICTURES.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=PICTURES / f"{name}.png", full_page=True)

    def assert_fits(self) -> None:
        """Check that nobody has to scroll sideways."""
        width = self.page.evaluate("[document.documentElement.scrollWidth, document.documentElement.clientWidth]")
        assert width[0] <= width[1], f"{width[0]} px of page on {width[1]} px of screen"

    def assert_accessible(self) -> None:
        """Check with axe what a machine can check of WCAG 2.2 AA."""
        self.page.evaluate(AXE.read_text())
        found = self.page.evaluate(
            "tags => axe.run(document, {runOnly: {type: 'tag', values: tags}}).then(r => r.violations)", STANDARD
        )
        violations = [f"{f['id']}: {n['target']} {n['failureSummary']}" for f in found for n in f["nodes"]]
        assert not violations, "\n".join(violations)
