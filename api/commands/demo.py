"""`livella demo`: the service with a simulated fleet, for a first look."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import httpx
import uvicorn
from pydantic import SecretStr
from rich.console import Console
from rich.panel import Panel

from api.app import create_app
from api.commands.demo_fleet import FLEET
from api.commands.demo_player import play
from api.commands.serve import spare_the_lasting
from api.services import access
from api.settings import Settings

HOST = "127.0.0.1"
GRACE = 5
"""s a request may still take after Ctrl-C"""
SILENT = 18.0
"""s without data after which a device is silent: nobody waits three days for it here"""

ABOUT = f"""\
{len(FLEET)} simulated vehicles are on the road; within two minutes they show every stage and every kind of alert.
A device that sends nothing for {SILENT:.0f} s counts as silent here; otherwise that takes three days.
Ctrl-C ends it all; nothing is kept."""


def run(port: int) -> None:
    """Serve on this machine only, play the fleet over HTTP, and leave nothing behind."""
    key = access.new_key()
    with _ended_by_signals(), TemporaryDirectory(prefix="livella-demo-") as directory:
        settings = Settings(
            host=HOST,
            port=port,
            data_dir=Path(directory),
            admin_key=SecretStr(key),
            alert_silent_hours=SILENT / 3600,
        )
        server = uvicorn.Server(
            uvicorn.Config(
                create_app(settings, when_ready=spare_the_lasting),
                host=HOST,
                port=port,
                log_level="warning",
                access_log=False,
                ws="none",
                timeout_graceful_shutdown=GRACE,
            )
        )
        listener = server.config.bind_socket()  # before the fleet starts: whoever else has the port ends us here
        with listener, _playing(f"http://{HOST}:{port}", key):
            server.run([listener])


@contextmanager
def _playing(server: str, key: str) -> Iterator[None]:
    """Play the fleet in threads from the moment the service is ready."""
    end = threading.Event()
    conductor = threading.Thread(target=_conduct, args=(server, key, end))
    conductor.start()
    try:
        yield
    finally:
        end.set()
        conductor.join()


def _conduct(server: str, key: str, end: threading.Event) -> None:
    console = Console(highlight=False)
    console.print("Starting, this takes a few seconds ...")
    if not _ready(server, end):
        return
    address = f"Open   [bold]{server}[/]\nKey    [bold]{key}[/]"
    console.print(Panel(f"{address}\n\n{ABOUT}", title="Livella", expand=False), soft_wrap=True)
    play(server, key, end)


def _ready(server: str, end: threading.Event) -> bool:
    """Wait until the service is ready; False when it ended before."""
    while not end.wait(0.2):
        try:
            if httpx.get(f"{server}/readyz", timeout=5.0).is_success:
                return True
        except httpx.TransportError:
            continue
    return False


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Let SIGTERM, and the closing of the terminal, end the demo as Ctrl-C does, with everything tidied up.

    The server takes SIGINT and SIGTERM while it runs; when it has ended it raises them again, for us.
    """
    former = {signal.SIGTERM: signal.signal(signal.SIGTERM, signal.default_int_handler)}
    if hasattr(signal, "SIGHUP"):
        former[signal.SIGHUP] = signal.signal(signal.SIGHUP, lambda *_: signal.raise_signal(signal.SIGTERM))
    try:
        with suppress(KeyboardInterrupt):
            yield
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)
