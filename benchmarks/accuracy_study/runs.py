"""Drives through the estimator, and its estimates beside the truth."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

import core
from core import Estimates, Event, EventKind, Outcome, Parameters, Samples, quaternion
from core.simulation import Drive

Floats = NDArray[np.float64]
Json = dict[str, Any]

MOVING = 1.0
"""m/s"""


class Errors(NamedTuple):
    """How far the reported estimate is off at K moments; nan where there is none."""

    angle: Floats
    """(K,) deg, total rotation"""
    nees: Floats
    """(K,) squared error about the vehicle's axes over the stated variance; 3 on average when it is honest"""


def run(params: Parameters, samples: Samples) -> Outcome:
    """Run a drive of a device nothing is known of."""
    return core.advance(params, core.initial_state(params), samples)[1]


def error_vector(q_vs: ArrayLike, truth: ArrayLike) -> Floats:
    """Give the rotation vector (..., 3), rad, about the vehicle's axes from the true to the estimated mounting."""
    return quaternion.rotation_vector(quaternion.multiply(q_vs, quaternion.conjugate(truth)))


def degrees_off(q_vs: ArrayLike, truth: ArrayLike) -> Floats:
    """Give the total rotation (...,) between two mountings, deg."""
    angle: Floats = np.degrees(quaternion.angle_between(q_vs, truth))
    return angle


def errors(estimates: Estimates, truth: Floats, times: Floats) -> Errors:
    """Look at the newest reported estimate at each of the (K,) times, s; `truth` is q_vs (4,)."""
    newest = np.searchsorted(estimates.t, times, side="right") - 1
    vector = error_vector(estimates.quaternion, truth)
    nees = np.sum((vector / estimates.sigma) ** 2, axis=-1)
    angle = np.degrees(np.linalg.norm(vector, axis=-1))
    return Errors(*(np.append(column, np.nan)[newest] for column in (angle, nees)))


def first_motion(drive: Drive) -> float:
    """Give the time at which the vehicle first moves, s; infinite if it never does."""
    moving = np.flatnonzero(np.abs(drive.truth.speed) > MOVING)
    return float(drive.truth.t[moving[0]]) if moving.size else float("inf")


def of_kind(events: tuple[Event, ...], kind: EventKind) -> list[Event]:
    """Pick the events of a kind."""
    return [event for event in events if event.kind is kind]


def confirmations(drive: Drive, events: tuple[Event, ...]) -> list[Json]:
    """Compare every confirmed mounting with the truth at that time: s, deg, deg."""
    found = []
    for event in of_kind(events, EventKind.CONFIRMED):
        if event.quaternion is None or event.sigma is None:
            continue
        vector = np.degrees(error_vector(event.quaternion, drive.truth.mount_at(event.t)))
        found.append({"t": event.t, "error": vector.tolist(), "sigma": np.degrees(event.sigma).tolist()})
    return found


def confirmations_of(outcome: Outcome, truth: Floats) -> list[Floats]:
    """Give the error vectors, deg, of the confirmations of a mounting that never changes."""
    found = of_kind(outcome.events, EventKind.CONFIRMED)
    return [np.degrees(error_vector(event.quaternion, truth)) for event in found if event.quaternion is not None]


def size(confirmation: Json) -> float:
    """Give the total error of a confirmation, deg."""
    return float(np.linalg.norm(confirmation["error"]))


def plain(values: Floats) -> list[float | None]:
    """Numbers for JSON, four decimals, None for nan."""
    return [round(float(value), 4) if np.isfinite(value) else None for value in values]
