"""Motion of a vehicle, computed from the samples kept when somebody asks, under the mounting that was in force then.

It is reconstructed chunk by chunk, so that the memory it takes does not grow with the period. Of its rows as many are
given as asked for: of each stretch of time the one with the largest acceleration on the plan, so that peaks survive.
"""

import math
from collections.abc import Iterator
from datetime import datetime, timedelta
from typing import Any, NamedTuple

import numpy as np

import core
from api import schemas
from api.services import kept_samples, presenting
from api.services.context import Context
from api.services.errors import UNKNOWN_DEVICE, LongSpanError, NotFoundError
from api.services.foresight import corrected
from api.services.kept_samples import Span
from core.motion import DEFAULT, VEHICLES, Motion, Origin, advance, initial_state
from core.quaternion import Floats
from storage import devices, mounts, raw_chunks
from storage.database import ReadSession
from storage.devices import Device
from storage.models import EPOCH, MICROSECOND, microseconds
from storage.mounts import Mount

LONGEST = timedelta(hours=6)
USUAL = timedelta(minutes=10)
"""of the newest samples, where no period is named"""
BEFORE = timedelta(minutes=2)
"""of samples before a period, from which its attitude, velocity and the gyroscope's bias are learnt"""
EARLIEST = EPOCH + timedelta(days=1)
"""no device has sent anything before, and a calendar has a beginning"""
USUAL_CLASS = "sedan"
EQUATOR, SQUARED_ECCENTRICITY = 6378137.0, 6.69437999e-3
"""m and none, of the ellipsoid of WGS 84"""


COLUMNS = (
    *("session", "t", "at", "bucket", "speed_mps"),
    *("longitudinal_mps2", "lateral_mps2", "vertical_mps2", "yaw_rate_dps", "roll_deg", "pitch_deg", "heading_deg"),
    *("w", "x", "y", "z", "sideslip_deg", "sideslip_sigma_deg"),
    *("east_m", "north_m", "up_m", "position_sigma_m", "dead_reckoned"),
)
"""of the table of rows; `at` in us since 1970, `bucket` the stretch of time that a row is of"""
DECIMALS = 8
PLACE = {name: index for index, name in enumerate(COLUMNS)}


class _Asked(NamedTuple):
    """What is computed."""

    device: Device
    mount: Mount | None
    start: datetime
    end: datetime
    spans: tuple[Span, ...]
    """sessions, with the samples before"""


def read(
    context: Context, device_id: str, start: datetime | None, end: datetime | None, max_points: int
) -> schemas.Motion:
    """Give the motion between two moments in at most `max_points` rows; none without samples, or without a mounting.

    Raises
    ------
    NotFoundError
        no such device.
    LongSpanError
        the period is longer than `LONGEST`.
    """
    with context.database.read() as tx:
        asked = _look_up(tx, device_id, start, end, context.clock())
    table, origin = _reconstruct(context, asked, max_points)
    return schemas.Motion.model_validate(
        {
            "device_id": device_id,
            "vehicle": asked.device.vehicle_class or USUAL_CLASS,
            "start": asked.start,
            "end": asked.end,
            "mount": None if asked.mount is None else asked.mount.n,
            "origin": None if origin is None else _shown(origin),
            "columns": _columns(table, [span.stretch.session for span in asked.spans]),
        }
    )


def _look_up(tx: ReadSession, device_id: str, start: datetime | None, end: datetime | None, now: datetime) -> _Asked:
    device = devices.find(tx, device_id)
    if device is None:
        raise NotFoundError(UNKNOWN_DEVICE)
    until = max(end or raw_chunks.newest(tx, device.pk) or now, EARLIEST)
    since = start or until - USUAL
    if until - since > LONGEST:
        raise LongSpanError(f"At most {LONGEST // timedelta(hours=1)} hours of motion are computed at once.")
    mount = mounts.before(tx, device.pk, until)
    if mount is None or (mount.ended_at is not None and mount.ended_at <= since):
        return _Asked(device, None, since, until, ())
    since = max(since, presenting.utc(mount.started_at, mount.t))
    until = min(until, mount.ended_at or until)
    found = raw_chunks.stretches(tx, device.pk, since - BEFORE, until)
    spans = (kept_samples.within(stretch, since - BEFORE, until) for stretch in found)
    return _Asked(device, mount, since, until, tuple(span for span in spans if span.stretch.pieces))


def _reconstruct(context: Context, asked: _Asked, max_points: int) -> tuple[Floats, Origin | None]:
    """Give the table of rows (N, COLUMNS), thinned, and where its positions begin."""
    tables, origin = [np.empty((0, len(COLUMNS)))], None
    lengths = [_length(span) for span in asked.spans]
    offsets, width = np.cumsum([0.0, *lengths]), max(sum(lengths) / max_points, 1e-9)
    for number, span in enumerate(asked.spans):
        for motion in _motions(context, asked.device, asked.mount, span):
            origin = origin or motion.origin
            table = _table(number, asked, span, motion, origin)
            passed = offsets[number] + table[:, PLACE["t"]] - _begin(span)
            table[:, PLACE["bucket"]] = np.clip(passed // width, 0, max_points - 1)
            tables.append(_peaks(table))
    table = _peaks(np.concatenate(tables))
    return table[np.argsort(table[:, PLACE["at"]], kind="stable")], origin  # sessions may overlap, as in history


def _begin(span: Span) -> float:
    """Give the first time of a session that is shown, s on its clock."""
    return max(span.start + BEFORE.total_seconds(), span.stretch.pieces[0].t_first)


def _length(span: Span) -> float:
    return max(min(span.end, span.stretch.pieces[-1].t_last) - _begin(span), 0.0)


def _motions(context: Context, device: Device, mount: Mount | None, span: Span) -> Iterator[Motion]:
    """Reconstruct a session chunk by chunk."""
    if mount is None:
        return
    vehicle, q_vs = VEHICLES[device.vehicle_class or USUAL_CLASS], np.array(mount.quaternion)
    state = initial_state()
    for sent in kept_samples.read(context, span):
        samples = corrected(device.accelerometer_calibration, sent)
        state, motion = advance(DEFAULT, vehicle, state, q_vs, samples)
        yield motion


def _table(number: int, asked: _Asked, span: Span, motion: Motion, origin: Origin | None) -> Floats:
    """Give the rows of a session within the period, in the units of the API."""
    time = microseconds(span.stretch.started_at) + np.rint(motion.t * 1e6)
    roll, pitch, yaw = np.degrees(core.quaternion.all_angles(motion.q_nv)).T
    moved = _between(origin, motion.origin)
    known = [
        *(np.full(time.size, number), motion.t, time, np.zeros(time.size), motion.velocity_v[:, 0]),
        *(*motion.a_v.T, np.degrees(motion.w_v[:, 2]), roll, pitch, (90.0 - yaw) % 360.0),
        *(*motion.q_nv.T, np.degrees(motion.sideslip), np.degrees(motion.sideslip_sigma)),
        *(*(motion.position_n + moved).T, motion.position_sigma, motion.dead_reckoned),
    ]
    table = np.stack(known, axis=-1)
    shown: Floats = table[(time >= microseconds(asked.start)) & (time <= microseconds(asked.end))]
    return shown


def _between(origin: Origin | None, other: Origin | None) -> Floats:
    """Give the way (3,) from one origin to another, m to the east, north and up of the first."""
    if origin is None or other is None or other == origin:
        return np.zeros(3)
    along = 1 - SQUARED_ECCENTRICITY * np.sin(origin.latitude) ** 2
    east = EQUATOR / np.sqrt(along) * np.cos(origin.latitude) * (other.longitude - origin.longitude)
    north = EQUATOR * (1 - SQUARED_ECCENTRICITY) / along**1.5 * (other.latitude - origin.latitude)
    return np.array([east, north, other.altitude - origin.altitude])


def _peaks(table: Floats) -> Floats:
    """Give one row of each bucket, in their order: that with the largest acceleration on the plan."""
    plan = np.nan_to_num(np.hypot(table[:, PLACE["longitudinal_mps2"]], table[:, PLACE["lateral_mps2"]]))
    bucket = table[:, PLACE["bucket"]]
    order = np.lexsort((-plan, bucket))
    chosen: Floats = table[np.sort(order[np.unique(bucket[order], return_index=True)[1]])]
    return chosen


def _columns(table: Floats, sessions: list[str]) -> dict[str, Any]:
    found: dict[str, Any] = {
        name: _known(table[:, place]) for name, place in PLACE.items() if name in schemas.MotionColumns.model_fields
    }
    return found | {
        "session": [sessions[int(number)] for number in table[:, PLACE["session"]]],
        "t": table[:, PLACE["t"]].tolist(),
        "at": [EPOCH + int(us) * MICROSECOND for us in table[:, PLACE["at"]]],
        "quaternion": [None if None in q else q for q in map(_known, table[:, PLACE["w"] : PLACE["z"] + 1])],
        "dead_reckoned": (table[:, PLACE["dead_reckoned"]] > 0).tolist(),
    }


def _known(values: Floats) -> list[float | None]:
    return [None if math.isnan(value) else value for value in values.round(DECIMALS).tolist()]


def _shown(origin: Origin) -> dict[str, float | None]:
    altitude = origin.altitude if np.isfinite(origin.altitude) else None
    return {"lat": float(np.degrees(origin.latitude)), "lon": float(np.degrees(origin.longitude)), "alt": altitude}
