"""Traces are an extra: off unless a collector is named."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest
from fastapi import FastAPI

from api import tracing
from tests.drives import chunks
from tests.server import ROOT, ServerProcess, running


def test_nothing_of_it_is_loaded_without_a_collector() -> None:
    program = (
        "import sys; from api.app import create_app; create_app(); sys.exit('opentelemetry.sdk.trace' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False).returncode == 0


def test_without_the_extra_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv(tracing.ENDPOINT, "http://127.0.0.1:1")
    monkeypatch.setitem(sys.modules, "opentelemetry.exporter.otlp.proto.http.trace_exporter", None)
    assert not tracing.install(FastAPI())
    assert "livella[otel]" in caplog.text


@pytest.fixture
def collected() -> Iterator[tuple[str, list[bytes]]]:
    """A collector: its address, and what it was sent."""
    got: list[bytes] = []

    class Collector(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            got.append(self.rfile.read(int(self.headers["Content-Length"])))
            self.send_response(200)
            self.send_header("Content-Length", "0")
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Collector) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}", got
        server.shutdown()


@pytest.mark.slow
def test_requests_and_statements_reach_the_collector(
    collected: tuple[str, list[bytes]], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("opentelemetry.instrumentation.fastapi")
    address, got = collected
    monkeypatch.setenv(tracing.ENDPOINT, address)
    monkeypatch.setenv("OTEL_BSP_SCHEDULE_DELAY", "100")
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_COMPRESSION", "none")
    server = ServerProcess(f"sqlite:///{tmp_path}/livella.db", tmp_path)
    with running(server) as api:
        device = api.add_device("traced")
        device.send(chunks()[0], 0, expect=200)
        server.stop()
    told = b"".join(got)
    assert b"/chunks" in told
    assert b"INSERT" in told
    assert device.key.encode() not in told
