"""Runs of the presets over simulated drives, looked at after each fix."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.reproduction.angles import error
from core import DEFAULT, THESIS, EventKind, Outcome, Parameters, Samples, State, advance, initial_state, quaternion
from core.samples import SPEED
from core.simulation import Drive

Floats = NDArray[np.float64]

PRESETS = {"thesis": replace(THESIS, change=replace(THESIS.change, window=math.inf)), "default": DEFAULT}
"""In these experiments the thesis' filter runs on undisturbed, as it did there."""
VERDICTS = (EventKind.VERIFICATION_PASSED, EventKind.VERIFICATION_FAILED)
STATES = 9
"""n in (5.3): the error state of the thesis"""


class Trace(NamedTuple):
    """A run; K fixes."""

    t: Floats
    q_vs: Floats
    """(K, 4), nan as long as there is no estimate"""
    average: Floats
    """(K, 4) the moving average (5.4)"""
    eigenvalue: Floats
    """(K,) largest of the normalised covariance (5.3)"""
    sigma: Floats
    """(K,) deg, largest stated sigma of the mounting about a vehicle axis"""
    stable: NDArray[np.bool_]
    candidate: NDArray[np.bool_]
    """(K,) STABLE and RELIABLE: the average is taken to the drive test"""


def pieces(samples: Samples, fixes: int = 1) -> Iterator[Samples]:
    """The samples up to each fix, or to each so many fixes."""
    begin = 0
    for row in samples.fix_row[fixes - 1 :: fixes] + 1:
        yield samples.slice(begin, row)
        begin = row


def trace(params: Parameters, drive: Drive) -> Trace:
    """Run a preset over a drive."""
    state, rows = initial_state(params), []
    for piece in pieces(drive.samples):
        state, outcome = advance(params, state, piece)
        estimate = outcome.status.estimate
        q_vs = np.full(4, np.nan) if estimate is None else estimate.quaternion
        candidate = _candidate(outcome) is not None
        stable = candidate or bool(state.settling["stable"][0])
        average, eigenvalue = state.settling["average"][0], _largest_eigenvalue(state)
        sigma = np.nan if estimate is None else np.degrees(estimate.sigma.max())
        rows.append((piece.t[-1], q_vs, average, eigenvalue, sigma, stable, candidate))
    return Trace(*(np.array(column) for column in zip(*rows, strict=True)))


def _candidate(outcome: Outcome) -> Floats | None:
    """The average taken to the drive test; STABLE and RELIABLE are reset in the very step that does so."""
    started = [event.quaternion for event in outcome.events if event.kind is EventKind.VERIFICATION_STARTED]
    return started[0] if started else None


def _largest_eigenvalue(state: State) -> float:
    covariance = state.filter["covariance"][0, :STATES, :STATES]
    total = float(np.trace(covariance))
    return STATES * float(np.linalg.eigvalsh(covariance)[-1]) / total if total > 0 else np.nan


class Believed(NamedTuple):
    """An estimate from nothing."""

    q_vs: Floats
    reliable: bool


def restarted(params: Parameters, drive: Drive, only_reliable: bool) -> list[Believed]:
    """Estimates of a drive, each from nothing: taken when STABLE (thesis 5.2.3) or only when RELIABLE too."""
    state, estimates = initial_state(params), []
    for piece in pieces(drive.samples, fixes=4):
        state, outcome = advance(params, state, piece)
        candidate = _candidate(outcome)
        if candidate is not None:
            estimates.append(Believed(candidate, True))
        elif state.settling["stable"][0] and not only_reliable:
            estimates.append(Believed(state.settling["average"][0].copy(), False))
        else:
            continue
        state = initial_state(params)
    return estimates


def final_error(params: Parameters, drive: Drive) -> float:
    """Total error at the end of a drive, degrees; nan without an estimate."""
    estimate = advance(params, initial_state(params), drive.samples)[1].status.estimate
    return float("nan") if estimate is None else error(estimate.quaternion, drive.truth.q_vs)


def drive_test(params: Parameters, drive: Drive, q_vs: Floats | None, offset: Floats, start: float) -> bool | None:
    """Put a mounting on the drive test at a time: `q_vs`, or the filter's estimate, turned by a rotation vector.

    Gives None when the drive ends before the test does.
    """
    cut = int(np.searchsorted(drive.samples.t, start))
    state, _ = advance(params, initial_state(params), drive.samples.slice(0, cut))
    candidate = state.verification
    candidate["state"] = 1
    q_vs = state.filter["q_vs"][0] if q_vs is None else q_vs
    candidate["q_vs"] = quaternion.multiply(quaternion.from_rotation_vector(offset), q_vs)
    candidate["bias"] = state.filter["bias"]
    for name in ("elapsed", "distance", "excess", "error"):
        candidate[name] = 0.0
    _, outcome = advance(params, state, drive.samples.slice(cut, len(drive.samples)))
    ended = [event.verification for event in outcome.events if event.kind in VERDICTS]
    return ended[0].error < ended[0].limit if ended and ended[0] is not None else None


def integrated_speed(drive: Drive, q_vs: Floats, start: float, seconds: float) -> tuple[Floats, Floats, Floats]:
    """Drive test as printed (5.6): times since the start, integrated speed and GPS speed at the fixes."""
    samples = drive.samples
    f_x = samples.f_s @ quaternion.matrix(q_vs)[0]
    speed = np.concatenate([[0.0], np.cumsum(0.5 * (f_x[1:] + f_x[:-1]) * np.diff(samples.t))])
    inside = (samples.t[samples.fix_row] >= start) & (samples.t[samples.fix_row] <= start + seconds + 0.1)
    rows, gps = samples.fix_row[inside], samples.fix[inside, SPEED]
    return samples.t[rows] - start, gps[0] + speed[rows] - speed[rows[0]], gps
