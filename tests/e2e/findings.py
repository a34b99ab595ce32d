"""Alerts of every kind, found as the service finds them and written into its database while it runs.

Driving until each of them is raised would take hours; what is raised, in which words and with which data, is the
service's own.
"""

import math
from datetime import UTC, datetime, timedelta
from typing import Any, NamedTuple

import numpy as np
import sqlalchemy as sa

import core
from api.services import findings, happenings, publishing
from api.services.rules import Limits, Seen, calibration_stalled, clock_fault, device_silent, gps_lost, harsh_driving
from api.services.rules import verification_failing as failing
from core import EventKind, Evidence, Fault, Stage
from core.motion.events import EventKind as MotionKind
from core.motion.events import MotionEvent
from core.quaternion import Floats
from storage import alerts
from storage import models as tables
from storage.alerts import Finding
from storage.database import Database

LIMITS = Limits()
LOOKS: Floats = 5.0 * np.arange(12.0)
EVIDENCE = Evidence(400.0 + LOOKS, np.maximum(0.0, 3.0 * LOOKS - 75.0), 60.0)


class Raised(NamedTuple):
    """An alert as the page shows it."""

    device_id: str
    english: str
    italian: str


def every_kind(now: datetime) -> dict[Raised, Finding]:
    """Give a finding of every kind and fault, and what the page calls it."""
    stalled = calibration_stalled.step(calibration_stalled.Memory(driving=1799.0), _seen(now), LIMITS)[1]
    without = gps_lost.step(gps_lost.Memory(without=1799.0), _seen(now, with_fix=0.0), LIMITS)[1]
    failure = core.Event(50.0, EventKind.VERIFICATION_FAILED, None, None, None, None, "the speed error was 4.1 m/s")
    failed = failing.step(failing.Memory(failed=3), _seen(now, events=(failure,)), LIMITS)[1]
    silent = device_silent.finding(now - timedelta(hours=80), now, LIMITS.silent)
    found: list[tuple[str, str, str, object]] = [
        ("van-1", "The device was turned 14° to the left", "è stato ruotato di 14° verso sinistra", _moved(now)),
        ("van-2", "The device is loose", "Il dispositivo è allentato", _fault(now, Fault.DEVICE_LOOSE)),
        ("van-3", "axes are a mirror image", "Gli assi del sensore sono speculari", _fault(now, Fault.LEFT_HANDED)),
        ("van-4", "An axis of the sensor is stuck", "Un asse del sensore è bloccato", _fault(now, Fault.STUCK_AXIS)),
        ("van-5", "Readings rest at the end", "Le letture restano al limite", _fault(now, Fault.SATURATED)),
        ("van-1", "Not confirmed after 31 min of driving", "Non confermato dopo 31 min di guida", stalled),
        ("van-1", "4 drive tests in a row have failed", "4 prove su strada di fila non superate", failed),
        ("van-1", "No GPS fix in 31 min of data", "Nessuna posizione GPS in 31 min di dati", without),
        ("van-1", "Nothing has come since", "Il dispositivo tace, ultimi dati:", silent),
        ("van-1", "The clock has run back by 40 s", "L’orologio è tornato indietro di 40 s", _back(now)),
        ("van-2", "The clock stands still", "L’orologio è fermo", _standing(now)),
        ("van-3", "The clock is 75 s ahead", "L’orologio è avanti di 75 s", _ahead(now)),
        ("van-4", "The clock is fast by 10 %", "L’orologio corre troppo, del 10 %", _fast(now)),
        ("van-5", "The vehicle was hit from the front left", "Il veicolo è stato urtato davanti a sinistra", _hit(now)),
        ("van-5", "3 harsh manoeuvres within 10 minutes", "3 manovre brusche in 10 minuti di guida", _harsh(now)),
    ]
    return {Raised(*shown): _checked(finding) for *shown, finding in found}


def raise_(url: str, device_id: str, finding: Finding, now: datetime) -> int:
    """Raise an alert as a process of the service does; give its number."""
    database = Database(url)
    with database.write() as tx:
        pk = tx.value(sa.select(tables.devices.c.pk).where(tables.devices.c.id == device_id))
        number = alerts.raise_(tx, pk, finding, now)
        publishing.alert_changed(tx, number, now, is_opened=True)
    database.close()
    return number


def raise_every_kind(url: str) -> list[Raised]:
    """Raise one of every kind, a minute apart, the newest last; the devices van-1 to van-5 have to be there."""
    now = datetime.now(UTC)
    kinds = every_kind(now)
    for n, (shown, finding) in enumerate(kinds.items()):
        raise_(url, shown.device_id, finding, now - timedelta(minutes=len(kinds) - n))
    return list(kinds)


def lost(now: datetime) -> Finding:
    """Give the simplest one."""
    return _checked(gps_lost.step(gps_lost.Memory(without=1799.0), _seen(now, with_fix=0.0), LIMITS)[1])


def _seen(now: datetime, **known: Any) -> Seen:
    """Give a minute of driving that has just come."""
    start = now - timedelta(seconds=60)
    usual = Seen("a", 1, start, now, 0.0, 60.0, 6000, 0, 0, 60.0, 60.0, 60.0, Stage.SETTLING, ("turn",), (), ())
    return usual._replace(**known)


def _where(now: datetime) -> findings.Where:
    return findings.Where("a", now - timedelta(seconds=460), 1)


def _moved(now: datetime) -> object:
    quaternion, sigma = np.array([1.0, 0.0, 0.0, 0.0]), np.radians([1.0, 2.0, 3.0])
    axis, angle = np.array([0.0, 0.0, 1.0]), float(np.radians(14.0))
    event = core.Event(
        455.0, EventKind.ORIENTATION_CHANGED, quaternion, sigma, None, angle, None, axis, 425.0, EVIDENCE
    )
    return findings.finding(event, _where(now))


def _fault(now: datetime, fault: Fault) -> object:
    event = core.Event(455.0, EventKind.FAULT, None, None, None, None, "what was seen", since=400.0, fault=fault)
    return findings.finding(event, _where(now))


def _back(now: datetime) -> object:
    memory = clock_fault.Memory(session=1, t=40.0)
    return clock_fault.step(memory, _seen(now, back=10), LIMITS)[1]


def _standing(now: datetime) -> object:
    return clock_fault.step(clock_fault.Memory(session=1), _seen(now, repeated=5900), LIMITS)[1]


def _ahead(now: datetime) -> object:
    agreed = now.timestamp() - 60.0 + 75.0
    return clock_fault.step(clock_fault.Memory(session=1, agreed=agreed, least=agreed), _seen(now), LIMITS)[1]


def _fast(now: datetime) -> object:
    begun = now.timestamp() - 600.5
    memory = clock_fault.Memory(session=1, window_r=begun, least=begun, rates=(1.1, 1.1))
    return clock_fault.step(memory, _seen(now, t_last=660.0), LIMITS)[1]


def _hit(now: datetime) -> object:
    event = MotionEvent(MotionKind.IMPACT, 9.0, 8.95, 0.09, 117.7, math.radians(38), (-5.55, -4.17), 12.0)
    return happenings.impact(1, "a", now, event, 1)


def _harsh(now: datetime) -> object:
    events = [
        MotionEvent(MotionKind.HARSH_BRAKING, t, t - 1, 1.0, 4.0, 0.0, (-3.0, 0.0), 12.0) for t in (9.0, 19.0, 29.0)
    ]
    return harsh_driving.step(harsh_driving.Memory(), _seen(now, happened=tuple(events)), LIMITS)[1]


def _checked(finding: object) -> Finding:
    assert isinstance(finding, Finding), finding
    return finding
