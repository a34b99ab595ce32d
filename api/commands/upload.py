"""`livella upload`: play a device that sends a log."""

import hashlib
import time
from pathlib import Path
from typing import Any

import httpx

from api.commands import output
from api.commands.device import Device, RefusedError, Service, UnavailableError, register
from api.formats import FormatError
from api.formats.files import Format, LogFile, chunks, open_log
from core import Samples


def run(
    path: Path,
    server: str,
    device_id: str,
    key: str,
    log_format: Format | None,
    course: str,
    chunk_seconds: float,
    realtime: float | None,
    session: str | None,
    new: bool,
) -> None:
    """Send a log in chunks and print the installation.

    Parameters
    ----------
    key
        the device's key, or with `new` that of an installer
    chunk_seconds
        s of log time in a chunk
    realtime
        chunks are sent when their last sample is due at this many times the speed of time; None = at once
    session
        None = named after the content and the chunks, so that an interrupted upload goes on where it was
    new
        register the device if it is not there
    """
    _check_address(server)
    log, samples = _open(path, log_format, course)
    name = session or _session_name(log, chunk_seconds)
    try:
        with Service(server, key, output.complain) as service:
            device_key = register(service, device_id, device_id) if new else None
            if device_key:
                _print(f"registered {device_id}; its key, shown only once: {device_key}")
        with Service(server, device_key or key, output.complain) as service:
            device = Device(service, device_id, name, log.media_type, course)
            answer, duplicates = _send(device, log, samples, chunk_seconds, realtime)
    except (RefusedError, UnavailableError) as error:
        output.fail(f"{path}: {error}")
    _report(answer, duplicates)


def _check_address(server: str) -> None:
    try:
        url = httpx.URL(server)
    except httpx.InvalidURL:
        url = httpx.URL()
    if url.scheme not in {"http", "https"} or not url.host:
        output.fail(f"{server}: expected an address such as http://127.0.0.1:8000", output.UNREADABLE)


def _open(path: Path, log_format: Format | None, course: str) -> tuple[LogFile, Samples]:
    try:
        log = open_log(path, log_format)
        return log, log.parse(course).samples().samples
    except OSError as error:
        output.fail(f"{path}: {error.strerror or error}", output.UNREADABLE)
    except FormatError as error:
        output.fail(f"{path}: {error}", output.UNREADABLE)


def _session_name(log: LogFile, chunk_seconds: float) -> str:
    return "log-" + hashlib.sha256(f"{chunk_seconds}\0".encode() + log.content).hexdigest()[:16]


def _send(
    device: Device, log: LogFile, samples: Samples, chunk_seconds: float, realtime: float | None
) -> tuple[dict[str, Any], int]:
    """Send every chunk; give the last answer and the number of chunks that were there already."""
    begin, first = time.monotonic(), float(samples.t[0])
    answer, duplicates = {}, 0
    with output.progress() as bar:
        task = bar.add_task("upload", total=float(samples.t[-1]) - first)
        for chunk in chunks(log, samples.t, chunk_seconds):
            if realtime is not None:
                time.sleep(max(0.0, begin + (chunk.until - first) / realtime - time.monotonic()))
            answer = device.send(chunk.content)
            duplicates += answer["chunk"]["duplicate"]
            bar.update(task, completed=chunk.until - first)
    return answer, duplicates


def _report(answer: dict[str, Any], duplicates: int) -> None:
    """Print where the installation stands."""
    installation, sent = answer["installation"], answer["chunk"]["seq"] + 1
    lines = [
        f"{sent} chunks sent to {installation['device_id']}"
        + (f", {duplicates} of them were there already" * bool(duplicates))
    ]
    lines.append(f"stage: {installation['stage']} ({installation['progress']:.0%}). {installation['hint']}")
    for title in ("mount", "estimate"):
        known = installation[title]
        if known:
            angles = output.angles(known["quaternion"], known["sigma_deg"])
            parts = [f"{name} {angle}" for name, angle in zip(output.ANGLES, angles, strict=True)]
            lines.append(f"{title}: {', '.join(parts)} deg")
    for line in lines:
        _print(line)


def _print(line: str) -> None:
    output.stdout().print(line, soft_wrap=True, highlight=False, markup=False)
