"""The page and the service agree: what one takes from the other is generated or copied, and compared here."""

import json
import math
import re
from pathlib import Path

import core
from api.app import create_app

WEB = Path(__file__).parents[2] / "web"


def test_the_page_is_made_for_this_api() -> None:
    described = json.loads((WEB / "openapi.json").read_text())
    assert described == create_app().openapi(), "run `npm run types` in web/"


def test_the_marks_of_how_sure_are_the_limits_of_the_estimator() -> None:
    source = (WEB / "src/device/sigma.ts").read_text()
    found = re.search(r"SIGMA_LIMIT = \[(.+?)\]", source)
    assert found is not None
    settling = core.DEFAULT.settling
    limits = [math.degrees(limit) for limit in (settling.tilt_sigma, settling.tilt_sigma, settling.yaw_sigma)]
    shown = [float(limit) for limit in found[1].split(",")]
    assert shown == [round(limit, 6) for limit in limits], "change web/src/device/sigma.ts with the estimator"
