"""Markup in a name is text to everybody who reads it: no script of a stranger runs on the page."""

import pytest

from api.headers import HEADERS
from tests.e2e.conftest import address, api, chromium, visitor
from tests.e2e.visitor import Visitor
from tests.service import Api

__all__ = ["address", "api", "chromium", "visitor"]  # fixtures

pytestmark = pytest.mark.browser

MARKUP = "<img src=x onerror='window.owned=1'>"
SCRIPT = "</script><script>window.owned=1</script>"
APPEND_SCRIPT = "text => document.body.append(Object.assign(document.createElement('script'), {textContent: text}))"
SCRIPT_MS = 300.0
"""ms that a script would need at most"""
LINK = "javascript:window.owned=1"


@pytest.mark.parametrize("path", ["/devices", "/devices/box-1"])
def test_markup_in_names_is_shown_as_text(visitor: Visitor, api: Api, path: str) -> None:
    api.add_device("box-1", name=MARKUP, vehicle=SCRIPT, notes=f"{LINK} {MARKUP}")
    visitor.sign_in()
    visitor.open(path)
    visitor.see(MARKUP)
    visitor.page.wait_for_timeout(SCRIPT_MS)
    assert not visitor.page.evaluate("'owned' in window")
    assert visitor.page.locator("img[onerror]").count() == 0
    assert visitor.page.locator("a[href^='javascript:']").count() == 0


def test_the_policy_keeps_even_injected_script_from_running(visitor: Visitor, api: Api) -> None:
    visitor.tolerated = (*visitor.tolerated, "Content Security Policy")
    visitor.sign_in()
    inject = "markup => document.body.insertAdjacentHTML('beforeend', markup)"
    visitor.page.evaluate(inject, MARKUP.replace("src=x", "src='data:,'"))
    visitor.page.evaluate(APPEND_SCRIPT, "window.owned=1")
    visitor.page.wait_for_timeout(SCRIPT_MS)
    assert not visitor.page.evaluate("'owned' in window")
    answer = visitor.page.goto(visitor.address)
    assert answer is not None
    assert answer.headers["content-security-policy"] == HEADERS["Content-Security-Policy"]
