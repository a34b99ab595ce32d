"""The page and the service agree: what one takes from the other is generated, and compared here."""

import json
from pathlib import Path

from api.app import create_app

WEB = Path(__file__).parents[2] / "web"


def test_the_page_is_made_for_this_api() -> None:
    described = json.loads((WEB / "openapi.json").read_text())
    assert described == create_app().openapi(), "run `npm run types` in web/"
