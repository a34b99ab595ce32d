"""Devices as cheap as they can be: requests made beforehand, answers read no further than their status and length.

Generator and service share the machine, so whatever a device costs here is missing there.
"""

import asyncio
import re
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple, cast

from benchmarks.load_study.pacing import OK, Answer, Plan, schedule

STATUS = slice(9, 12)
LENGTH = re.compile(rb"\r\ncontent-length: *(\d+)", re.IGNORECASE)
CLOSING = re.compile(rb"\r\nconnection: *close", re.IGNORECASE)
SOURCES = 40
"""addresses of 127/8 that connections come from: one address has ports for 28,000"""
CONNECTING = 100
"""connections that are opened at once"""
RETRY_AFTER = re.compile(rb"\r\nretry-after: *(\d+)", re.IGNORECASE)
RECONNECT = 1.0
"""s until a device tries again whose connection broke with a chunk under way, or could not be opened"""
PROBED = 400
"""connections, at most, over which it is asked whether the process at the other end is ready"""
HOPELESS = 10.0
"""s: when as many chunks wait for an answer as become due in that time, the count is not held, and the run ends"""
PATIENCE = 0.2
"""s until it is asked again when the answer does not say how long to wait"""


class Body(NamedTuple):
    """A chunk as it is sent."""

    headers: bytes
    """those that tell of the body, each line with its end"""
    content: bytes


class Device:
    """Sends its chunks in order; one that was refused is sent again when the next is due."""

    def __init__(self, name: str, key: str, session: str, bodies: Sequence[Body], first_seq: int) -> None:
        self.name = name
        self.bodies = bodies
        self.session = session
        self.key = key
        self.acknowledged = 0
        self.unsure = False
        """what was sent last has no answer: it may be stored or not"""
        self.first_seq = first_seq

    def stored_as_told(self, count: int) -> bool:
        """Tell whether the number of chunks that are stored is what was acknowledged."""
        return count - self.acknowledged in ({0, 1} if self.unsure else {0})

    def request(self, host: str) -> tuple[bytes, bytes]:
        """Give head and body of the next request."""
        body = self.bodies[self.acknowledged % len(self.bodies)]
        path = f"/api/v1/devices/{self.name}/chunks?session={self.session}&seq={self.first_seq + self.acknowledged}"
        head = f"POST {path} HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {self.key}\r\n"
        return head.encode() + body.headers + b"\r\n", body.content


class Connection(asyncio.Protocol):
    """A connection kept alive; one request at a time, what is due meanwhile queues."""

    def __init__(self, run: "Run", index: int) -> None:
        self.run = run
        self.index = index
        self.transport: asyncio.Transport | None = None
        self.queue: deque[tuple[Device, float]] = deque()
        self.busy = False
        self.asked: asyncio.Future[float] | None = None
        self.received = bytearray()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Go on with what has queued."""
        self.transport = cast(asyncio.Transport, transport)  # uvloop's are no subclass
        self.received.clear()
        if not self.busy and self.queue:
            self._send()

    def connection_lost(self, exc: Exception | None) -> None:
        """Count what was under way as broken, and connect again: later then, at once where nothing was under way.

        The service hangs up on who says nothing for a minute after connecting, as those whose first chunk is due last.
        """
        self.transport = None
        self._told(RECONNECT)
        broken = self.busy
        if broken:
            self._answered(0)
        if not self.run.closing:
            self.run.loop.call_later(RECONNECT if broken else 0.0, self.run.reconnect, self)

    def post(self, device: Device, due: float) -> None:
        """A chunk is due."""
        self.queue.append((device, due))
        if not self.busy and self.transport is not None:
            self._send()

    def _send(self) -> None:
        assert self.transport is not None
        self.busy = True
        device = self.queue[0][0]
        device.unsure = True
        self.transport.writelines(device.request(self.run.host))

    async def until_ready(self) -> None:
        """Ask the process at the other end, before anything is due, until it is ready."""
        pause = PATIENCE
        while pause:
            if self.transport is not None:
                self.asked = self.run.loop.create_future()
                self.transport.write(f"GET /readyz HTTP/1.1\r\nHost: {self.run.host}\r\n\r\n".encode())
                pause = await self.asked
            await asyncio.sleep(pause)

    def _told(self, pause: float) -> None:
        if self.asked is not None and not self.asked.done():
            self.asked.set_result(pause)
        self.asked = None

    def data_received(self, data: bytes) -> None:
        """Wait for the end of the answer."""
        self.received += data
        end = self.received.find(b"\r\n\r\n")
        if end < 0:
            return
        length = LENGTH.search(self.received, 0, end)
        if length is None or len(self.received) < end + 4 + int(length[1]):
            return
        status, closing = int(self.received[STATUS]), CLOSING.search(self.received, 0, end)
        wait = RETRY_AFTER.search(self.received, 0, end)
        self.received.clear()
        if closing and self.transport is not None:
            self.transport.close()
            self.transport = None
        if self.asked is None:
            self._answered(status)
        else:
            self._told(0.0 if status == OK else float(wait[1]) if wait else PATIENCE)

    def _answered(self, status: int) -> None:
        device, due = self.queue.popleft()
        self.busy = False
        device.acknowledged += status == OK
        device.unsure = status == 0
        self.run.answers.append(Answer(due, self.run.now() - due, status))
        if self.queue and self.transport is not None:
            self._send()


class Run:
    """One run of a fleet against a service."""

    def __init__(self, port: int, devices: Sequence[Device], connections: int) -> None:
        self.port = port
        self.host = f"127.0.0.1:{port}"
        self.devices = devices
        self.loop = asyncio.get_running_loop()
        self.connections = [Connection(self, i) for i in range(min(connections, len(devices)))]
        self.answers: list[Answer] = []
        self.closing = False
        self._zero = 0.0
        self._opening: set[asyncio.Task[None]] = set()

    def now(self) -> float:
        """Give the s since the start."""
        return time.monotonic() - self._zero

    async def connect(self) -> None:
        """Open every connection before anything is due."""
        for start in range(0, len(self.connections), CONNECTING):
            await asyncio.gather(*(self._open(one) for one in self.connections[start : start + CONNECTING]))

    async def until_ready(self, seconds: float) -> None:
        """Wait until the processes that the connections lead to, all of them, are ready."""
        probed = self.connections[:: -(-len(self.connections) // PROBED)]
        await asyncio.wait_for(asyncio.gather(*(one.until_ready() for one in probed)), seconds)

    async def _open(self, connection: Connection) -> None:
        source = f"127.0.0.{2 + connection.index % SOURCES}"
        try:
            await self.loop.create_connection(lambda: connection, "127.0.0.1", self.port, local_addr=(source, 0))
        except OSError:
            self.loop.call_later(RECONNECT, self.reconnect, connection)

    def reconnect(self, connection: Connection) -> None:
        """Open a connection once more."""
        if self.closing:
            return
        task = self.loop.create_task(self._open(connection))
        self._opening.add(task)
        task.add_done_callback(self._opening.discard)

    async def play(self, plan: Plan, at_start: Callable[[], None], at_end: Callable[[], None], drain: float) -> float:
        """Post what becomes due in a plan; call `at_start` after the warm-up and `at_end` when nothing more is due.

        Gives the s after which it ended: those of the plan, or fewer if there was no hope.
        """
        self._zero = time.monotonic()
        started, look = False, plan.warm_up + HOPELESS
        for due, i in schedule(plan):
            if (wait := due - self.now()) > 0:
                await asyncio.sleep(wait)
            if not started and due >= plan.warm_up:
                started = True
                at_start()
            if due >= look:
                look = due + 1.0
                if self.unanswered() > HOPELESS * plan.rate:
                    at_end()
                    return due
            self.connections[i % len(self.connections)].post(self.devices[i], due)
        await asyncio.sleep(max(0.0, plan.seconds - self.now()))
        at_end()
        await self._drain(drain)
        return plan.seconds

    async def _drain(self, seconds: float) -> None:
        deadline = time.monotonic() + seconds
        while any(one.queue for one in self.connections) and time.monotonic() < deadline:
            await asyncio.sleep(0.05)

    def unanswered(self) -> int:
        """Count what was due and has no answer."""
        return sum(len(one.queue) for one in self.connections)

    async def close(self) -> None:
        """Hang up."""
        self.closing = True
        for task in self._opening:
            task.cancel()
        for connection in self.connections:
            if connection.transport is not None:
                connection.transport.close()
        await asyncio.sleep(0.1)
