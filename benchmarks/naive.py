"""A baseline for `make bench-load`: the same upload as one would write it first, served beside Livella for the ratio.

What it does: FastAPI and uvicorn like Livella, `POST /api/v1/devices/{id}/chunks` with a key, CSV with or without zstd;
pyarrow reads the CSV (as fast as pandas), `scipy.signal.decimate` brings it to the rate of the fixes, an error-state
Kalman filter in numpy takes one step per fix, an ORM session per request with one commit stores the receipt, the
angles every 5 s and the state as JSON. SQLite in WAL mode, durable (`synchronous=FULL`), waiting up to 30 s for its
turn.

What it leaves out, all of it in its favour: chunks that come out of order, events, alerts, the live stream, webhooks,
the drive test of a mounting, the second filter that watches over a confirmed one, faults of the GPS, decimation across
the border of chunks, and limits on what a chunk may hold; its filter has 9 states where Livella's has 22. It finds the
mounting of an undisturbed drive to a degree or two, which a test holds, and serves as a load only.
"""

import hashlib
import math
import os
from collections.abc import Iterator
from io import BytesIO
from typing import Annotated, Any, NamedTuple

import numpy as np
import zstandard
from fastapi import Body, Depends, FastAPI, Header, HTTPException
from numpy.typing import NDArray
from pyarrow import csv
from scipy.signal import decimate
from scipy.spatial.transform import Rotation
from sqlalchemy import JSON, ForeignKey, UniqueConstraint, create_engine, event, select
from sqlalchemy.orm import DeclarativeBase, Mapped, Session, mapped_column, sessionmaker

Floats = NDArray[np.float64]

GRAVITY = 9.81
INITIAL_SIGMA = np.array([0.2, 0.2, 0.2, 0.2, 0.2, 0.2, 0.05, 0.05, 1.0])
"""mounting (rad), bias (m/s2), pitch, roll (rad), acceleration (m/s2)"""
PROCESS_SIGMA = np.array([1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 0.01, 0.01, 1.0])
"""per square root of s"""
MEASUREMENT_SIGMA = np.array([0.3, 0.3, 0.3, 0.3, 0.05, 0.03])
"""specific force (m/s2), acceleration from the speeds (m/s2), grade, roll (rad)"""
MOVING = 3.0
"""m/s"""
ESTIMATE_EVERY = 20
"""steps between two rows of the history: 5 s"""


class Base(DeclarativeBase):
    """Tables."""


class Device(Base):
    """A box in a vehicle."""

    __tablename__ = "devices"
    id: Mapped[str] = mapped_column(primary_key=True)
    key_hash: Mapped[str] = mapped_column(unique=True)
    state: Mapped[dict[str, Any] | None] = mapped_column(JSON)


class Chunk(Base):
    """The receipt of an upload."""

    __tablename__ = "chunks"
    __table_args__ = (UniqueConstraint("device_id", "session", "seq"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    device_id: Mapped[str] = mapped_column(ForeignKey("devices.id"))
    session: Mapped[str]
    seq: Mapped[int]
    digest: Mapped[str]
    samples: Mapped[int]


class Estimate(Base):
    """A row of the history."""

    __tablename__ = "estimates"
    id: Mapped[int] = mapped_column(primary_key=True)
    device_id: Mapped[str] = mapped_column(ForeignKey("devices.id"), index=True)
    t: Mapped[float]
    quaternion: Mapped[list[float]] = mapped_column(JSON)
    sigma: Mapped[list[float]] = mapped_column(JSON)


class Epochs(NamedTuple):
    """A chunk at the rate of the fixes."""

    t: Floats
    f_s: Floats
    speed: Floats
    acceleration: Floats
    yaw_rate: Floats
    grade: Floats


def read(content: bytes) -> tuple[int, Epochs]:
    """Read a chunk; give its number of samples too."""
    log = csv.read_csv(BytesIO(content))
    column = {name: log[name].to_numpy().astype(float) for name in log.column_names}
    t, fix = column["t"], column["fix"] == 1
    rate = 1.0 / float(np.median(np.diff(t)))
    force = np.column_stack([column[name] for name in ("ax", "ay", "az")])
    factor = max(1, round(rate / 20.0))
    slow = decimate(decimate(force, factor, axis=0), 5, axis=0)
    at = t[:: factor * 5]
    when, speed, altitude = t[fix], column["speed"][fix], column["alt"][fix]
    course = np.unwrap(np.radians(column["course"][fix]))
    climb = np.gradient(altitude, when)
    return len(t), Epochs(
        t=when,
        f_s=np.column_stack([np.interp(when, at, slow[:, i]) for i in range(3)]),
        speed=speed,
        acceleration=np.gradient(speed, when),
        yaw_rate=-np.gradient(course, when),
        grade=np.arctan2(climb, np.maximum(speed, MOVING)),
    )


class Filter:
    """Error-state Kalman filter of the mounting."""

    def __init__(self, q_sv: list[float], x: Floats, P: Floats) -> None:
        self.R_sv = Rotation.from_quat(q_sv).as_matrix()
        self.x = x
        """bias (3), pitch, roll, acceleration"""
        self.P = P

    @classmethod
    def start(cls, epochs: Epochs) -> "Filter":
        """Begin with gravity, and with the direction in which the vehicle gains speed."""
        up = epochs.f_s.mean(axis=0)
        up /= np.linalg.norm(up)
        forward = epochs.acceleration @ (epochs.f_s - epochs.f_s.mean(axis=0)) + 1e-9 * np.array([1.0, 0.7, 0.3])
        forward -= up * (up @ forward)
        forward /= np.linalg.norm(forward)
        R_sv = np.column_stack([forward, np.cross(up, forward), up])
        return cls(Rotation.from_matrix(R_sv).as_quat().tolist(), np.zeros(6), np.diag(INITIAL_SIGMA**2))

    @classmethod
    def load(cls, state: dict[str, Any]) -> "Filter":
        """Go on."""
        return cls(state["q_sv"], np.array(state["x"]), np.array(state["P"]))

    def dump(self) -> dict[str, Any]:
        """Give the state for the database."""
        q_sv = Rotation.from_matrix(self.R_sv).as_quat().tolist()
        return {"q_sv": q_sv, "x": self.x.tolist(), "P": self.P.tolist()}

    def step(self, dt: float, f_s: Floats, speed: float, acceleration: float, yaw_rate: float, grade: float) -> None:
        """Predict, then update with one fix and the specific force at its time."""
        self.P = self.P + np.diag(PROCESS_SIGMA**2 * dt)
        if speed < MOVING:
            return
        pitch, roll, along = self.x[3:]
        sp, cp, sr, cr = math.sin(pitch), math.cos(pitch), math.sin(roll), math.cos(roll)
        f_v = np.array([along + GRAVITY * sp, speed * yaw_rate + GRAVITY * cp * sr, GRAVITY * cp * cr])
        cross = np.array([[0.0, -f_v[2], f_v[1]], [f_v[2], 0.0, -f_v[0]], [-f_v[1], f_v[0], 0.0]])
        H = np.zeros((6, 9))
        H[:3, :3] = self.R_sv @ cross
        H[:3, 3:6] = np.eye(3)
        H[:3, 6] = self.R_sv @ np.array([GRAVITY * cp, -GRAVITY * sp * sr, -GRAVITY * sp * cr])
        H[:3, 7] = self.R_sv @ np.array([0.0, GRAVITY * cp * cr, -GRAVITY * cp * sr])
        H[:3, 8] = self.R_sv[:, 0]
        H[3, 8] = H[4, 6] = H[5, 7] = 1.0
        residual = np.concatenate([f_s - self.R_sv @ f_v - self.x[:3], [acceleration - along, grade - pitch, -roll]])
        R = np.diag(MEASUREMENT_SIGMA**2)
        K = self.P @ H.T @ np.linalg.inv(H @ self.P @ H.T + R)
        error = K @ residual
        rest = np.eye(9) - K @ H
        self.P = rest @ self.P @ rest.T + K @ R @ K.T
        self.R_sv = self.R_sv @ Rotation.from_rotvec(error[:3]).as_matrix().T
        self.x = self.x + error[3:]

    def quaternion(self) -> list[float]:
        """Give q_vs, scalar first."""
        x, y, z, w = Rotation.from_matrix(self.R_sv.T).as_quat(canonical=True).tolist()
        return [w, x, y, z]

    def sigma(self) -> list[float]:
        """Give the sigma of the mounting, degrees."""
        sigmas: list[float] = np.degrees(np.sqrt(np.diag(self.P)[:3])).tolist()
        return sigmas


def run(kalman: Filter, device_id: str, epochs: Epochs) -> list[Estimate]:
    """Step through a chunk."""
    estimates = []
    steps = np.diff(epochs.t, prepend=epochs.t[0])
    for i in range(len(epochs.t)):
        values = (epochs.speed[i], epochs.acceleration[i], epochs.yaw_rate[i], epochs.grade[i])
        kalman.step(float(steps[i]), epochs.f_s[i], *map(float, values))
        if i % ESTIMATE_EVERY == 0:
            told = {"quaternion": kalman.quaternion(), "sigma": kalman.sigma()}
            estimates.append(Estimate(device_id=device_id, t=float(epochs.t[i]), **told))
    return estimates


engine = create_engine(os.environ.get("NAIVE_DATABASE_URL", "sqlite://"), connect_args={"timeout": 30})
open_session = sessionmaker(engine)
app = FastAPI()


@event.listens_for(engine, "connect")
def _durable(connection: Any, _: object) -> None:
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA synchronous=FULL")


def database() -> Iterator[Session]:
    """Give a session of the ORM."""
    with open_session() as session:
        yield session


Orm = Annotated[Session, Depends(database)]


def key_hash(key: str) -> str:
    """Give what is stored of a key."""
    return hashlib.sha256(key.encode()).hexdigest()


@app.get("/readyz")
def readyz() -> dict[str, str]:
    """Tell that it runs."""
    return {"status": "ready"}


@app.post("/api/v1/devices/{device_id}/chunks")
def upload(
    device_id: str,
    session: str,
    seq: int,
    body: Annotated[bytes, Body(media_type="text/csv")],
    orm: Orm,
    authorization: Annotated[str, Header()],
    content_encoding: Annotated[str | None, Header()] = None,
) -> dict[str, Any]:
    """Take in a chunk."""
    device = orm.scalar(select(Device).where(Device.key_hash == key_hash(authorization.removeprefix("Bearer "))))
    if device is None or device.id != device_id:
        raise HTTPException(403)
    digest = hashlib.sha256(body).hexdigest()
    known = orm.scalar(select(Chunk).where(Chunk.device_id == device_id, Chunk.session == session, Chunk.seq == seq))
    if known is not None:
        if known.digest != digest:
            raise HTTPException(409)
        return {"chunk": {"session": session, "seq": seq, "duplicate": True}}
    content = zstandard.ZstdDecompressor().decompressobj().decompress(body) if content_encoding == "zstd" else body
    samples, epochs = read(content)
    kalman = Filter.start(epochs) if device.state is None else Filter.load(device.state)
    orm.add_all(run(kalman, device_id, epochs))
    orm.add(Chunk(device_id=device_id, session=session, seq=seq, digest=digest, samples=samples))
    device.state = kalman.dump()
    orm.commit()
    return {
        "chunk": {"session": session, "seq": seq, "samples": samples, "duplicate": False, "state": "applied"},
        "installation": {"device_id": device_id, "quaternion": kalman.quaternion(), "sigma_deg": kalman.sigma()},
    }
