import socket
import ssl
import subprocess
import time
from datetime import UTC, datetime
from ipaddress import ip_address
from pathlib import Path
from typing import Any

import httpcore
import pytest

from api.services import webhooks, webhooks_network, webhooks_sending
from api.services.errors import WebhookUrlError
from api.services.webhooks_sending import Result, Sender
from storage.webhooks import Webhook
from tests.receiver import Answer, Receiver, running_receiver

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
PRIVATE = [
    "127.0.0.1",
    "127.8.9.10",
    "0.0.0.0",  # noqa: S104
    "10.0.0.1",
    "100.64.0.1",
    "169.254.169.254",
    "172.16.0.1",
    "192.0.0.1",
    "192.168.1.1",
    "198.18.0.1",
    "224.0.0.1",
    "240.0.0.1",
    "255.255.255.255",
    "::",
    "::1",
    "::127.0.0.1",
    "::ffff:127.0.0.1",
    "::ffff:a00:1",
    "64:ff9b::7f00:1",
    "64:ff9b:1::1",
    "2002:7f00:1::",
    "2001:0:1::1",
    "2001:db8::1",
    "fc00::1",
    "fd12:3456::1",
    "fe80::1",
    "fe80::1%lo",
    "ff02::1",
]
SPELLINGS = [
    "localhost",
    "127.1",
    "2130706433",
    "0x7f000001",
    "0x7f.1",
    "0177.0.0.1",
    "0",
    "127.0.0.1.",
    "[::1]",
    "[::]",
    "[::ffff:127.0.0.1]",
    "[::ffff:7f00:1]",
    "[0:0:0:0:0:ffff:169.254.169.254]",
    "①②⑦.0.0.1",
    "LOCALHOST",
]


@pytest.fixture
def receiver() -> Any:
    with running_receiver() as running:
        yield running


def webhook(url: str) -> Webhook:
    return Webhook(1, "a", url, None, None, webhooks.new_secret(), True, NOW, None, None, None)


def send(url: str, allow_private: bool = True) -> Result:
    with Sender(allow_private) as sender:
        return sender.send(webhook(url), "msg_1", "{}", NOW)


@pytest.mark.parametrize("address", PRIVATE)
def test_addresses_that_are_not_public(address: str) -> None:
    assert not webhooks_network.is_public(ip_address(address))


@pytest.mark.parametrize(
    "address", ["1.1.1.1", "93.184.216.34", "2606:4700::1111", "::ffff:1.1.1.1", "64:ff9b::101:101"]
)
def test_addresses_that_are_public(address: str) -> None:
    assert webhooks_network.is_public(ip_address(address))


@pytest.mark.parametrize("host", SPELLINGS)
def test_no_spelling_reaches_a_private_address(host: str, receiver: Receiver) -> None:
    url = receiver.url.replace("127.0.0.1", host)
    assert send(url, allow_private=False).error is not None
    assert receiver.calls == []
    if host.isascii() and not host.endswith("."):  # that one is no name either
        with pytest.raises(WebhookUrlError):
            webhooks.check_url(url.replace("http:", "https:"), allow_private=False)


@pytest.mark.parametrize("addresses", [["127.0.0.1"], ["1.1.1.1", "10.0.0.1"], ["2606:4700::1111", "::1"]])
def test_a_name_with_any_private_address_is_refused(
    addresses: list[str], receiver: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    name_server(monkeypatch, [addresses])
    result = send(receiver.url.replace("127.0.0.1", "hooks.example"), allow_private=False)
    assert result.error == "the address is not one of the public internet"
    with pytest.raises(WebhookUrlError):
        webhooks.check_url("https://hooks.example/", allow_private=False)


def test_the_connection_goes_to_the_address_that_was_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = name_server(monkeypatch, [["1.2.3.4"], ["127.0.0.1"]])
    dialled: list[str] = []

    def connect(self: Any, host: str, *args: Any) -> Any:
        dialled.append(host)
        raise httpcore.ConnectError("nobody there")

    monkeypatch.setattr(httpcore.SyncBackend, "connect_tcp", connect)
    assert send("https://hooks.example/", allow_private=False).error == "nobody there"
    assert (asked, dialled) == (["hooks.example"], ["1.2.3.4"])


def name_server(monkeypatch: pytest.MonkeyPatch, answers: list[list[str]]) -> list[str]:
    """Answer for names from a list, one question after the other; give the names asked for."""
    asked: list[str] = []

    def getaddrinfo(host: str, port: int, **_: Any) -> list[Any]:
        asked.append(host)
        told = answers[min(len(asked), len(answers)) - 1]
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (address, port)) for address in told]

    monkeypatch.setattr(socket, "getaddrinfo", getaddrinfo)
    return asked


@pytest.mark.parametrize(
    "url",
    [
        "http://example.com/",
        "ftp://example.com/",
        "file:///etc/passwd",
        "https://",
        "https:///path",
        "//example.com/",
        "example.com",
        "https://user:password@1.1.1.1/",
        "https://user@1.1.1.1/",
        "https://1.1.1.1/#part",
        "https://[::1",
        "https://1.1.1.1:99999/",
    ],
)
def test_urls_that_are_refused(url: str) -> None:
    with pytest.raises(WebhookUrlError):
        webhooks.check_url(url, allow_private=False)


def test_urls_that_are_taken() -> None:
    webhooks.check_url("https://1.1.1.1:8443/hook?token=1", allow_private=False)
    webhooks.check_url("https://not-yet.invalid/", allow_private=False)
    webhooks.check_url("http://127.0.0.1/hook", allow_private=True)


def test_a_redirect_is_not_followed(receiver: Receiver) -> None:
    receiver.answer = Answer(302, (("Location", receiver.url + "/elsewhere"),))
    result = send(receiver.url)
    assert (result.status, result.delivered) == (302, False)
    assert result.error == "the receiver answered 302; redirects are not followed"
    assert [call.path for call in receiver.calls] == ["/hook"]


@pytest.mark.parametrize("status", [200, 503])
def test_a_huge_answer_is_not_read(receiver: Receiver, status: int) -> None:
    receiver.answer = Answer(status, size=1 << 30)
    begun = time.monotonic()
    assert send(receiver.url).status == status
    assert time.monotonic() - begun < 5


def test_endless_headers_end_the_call(receiver: Receiver) -> None:
    receiver.answer = Answer(200, tuple((f"X-{n}", "y" * 4000) for n in range(40)))
    result = send(receiver.url)
    assert (result.status, result.delivered) == (None, False)


def test_a_slow_receiver_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that sends a byte of its headers now and then keeps within every timeout between two bytes."""
    monkeypatch.setattr(webhooks_sending, "SECONDS", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        drip = subprocess.Popen(
            ["python", "-c", DRIP, str(listener.fileno())], pass_fds=[listener.fileno()], stderr=subprocess.DEVNULL
        )
        try:
            begun = time.monotonic()
            result = send(f"http://127.0.0.1:{listener.getsockname()[1]}/")
            assert time.monotonic() - begun < 5
        finally:
            drip.kill()
            drip.wait()
    assert not result.delivered
    assert result.error.startswith("no answer within") if result.error else False


DRIP = """
import socket, sys, time
connection, _ = socket.socket(fileno=int(sys.argv[1])).accept()
for byte in b"HTTP/1.1 200 OK\\r\\n" + b"X-Slow: 1\\r\\n" * 1000:
    connection.sendall(bytes([byte]))
    time.sleep(0.05)
"""


def test_nobody_listens() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    result = send(f"http://127.0.0.1:{port}/")
    assert result.status is None
    assert result.error is not None
    assert "refused" in result.error


@pytest.fixture
def certificate(tmp_path: Path) -> tuple[Path, Path]:
    """A certificate for localhost that nobody has signed."""
    certificate, key = tmp_path / "certificate.pem", tmp_path / "key.pem"
    subject = ["-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"]
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", *subject]
    subprocess.run([*command, "-keyout", str(key), "-out", str(certificate)], check=True, capture_output=True)
    return certificate, key


def test_tls_is_verified_for_the_name_in_the_url(
    certificate: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    names: list[str | None] = []
    tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    tls.load_cert_chain(*certificate)
    tls.sni_callback = lambda _connection, name, _context: names.append(name)
    with running_receiver(tls) as receiver:
        by_name = receiver.url.replace("127.0.0.1", "localhost")
        assert "CERTIFICATE_VERIFY_FAILED" in str(send(by_name).error)
        monkeypatch.setenv("SSL_CERT_FILE", str(certificate[0]))
        assert send(by_name).status == 204
        assert "CERTIFICATE_VERIFY_FAILED" in str(send(receiver.url).error)
    assert names == ["localhost", "localhost", None]
    assert [call.headers["host"] for call in receiver.calls] == [by_name.split("/")[2]]
