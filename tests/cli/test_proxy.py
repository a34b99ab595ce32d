"""Behind a reverse proxy that ends TLS: what it says about the caller is believed only when the setting names it."""

from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.cli import livella
from tests.service import ADMIN_KEY

FORWARDED = {"X-Forwarded-Proto": "https", "X-Forwarded-For": "192.0.2.7"}


@pytest.mark.parametrize(("proxies", "is_believed"), [("127.0.0.1", True), ("192.0.2.1,10.0.0.0/8", False)])
def test_what_a_proxy_says_is_believed_if_it_is_one_of_ours(tmp_path: Path, proxies: str, is_believed: bool) -> None:
    environment: dict[str, Any] = {"LIVELLA_ADMIN_KEY": ADMIN_KEY, "LIVELLA_FORWARDED_ALLOW_IPS": proxies}
    with livella.serving(tmp_path, **environment) as (url, _), httpx.Client(base_url=f"{url}/api/v1") as client:
        signed_in = client.post("/session", json={"key": ADMIN_KEY}, headers=FORWARDED)
        assert ("Secure" in signed_in.headers["set-cookie"]) == is_believed
        headers = {"Authorization": f"Bearer {ADMIN_KEY}"}
        (entry,) = client.get("/audit", params={"action": "session.sign_in"}, headers=headers).json()["items"]
        assert entry["detail"] == {"address": "192.0.2.7" if is_believed else "127.0.0.1"}
