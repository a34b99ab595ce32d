"""One epoch of the filter, three ways: the kernel, and numpy and filterpy with the matrices it stands for."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from filterpy.kalman import KalmanFilter
from numba import njit
from numpy.typing import NDArray

import core
from core import _kernel
from core.params import as_record

Floats = NDArray[np.float64]


class Minute(NamedTuple):
    """What the filter goes through in a minute."""

    params: NDArray[np.void]
    """(1,)"""
    filters: NDArray[np.void]
    """(2,) as they are at its beginning"""
    epochs: NDArray[np.void]
    """(N,)"""

    @property
    def states(self) -> int:
        """How many states the filter carries."""
        return _kernel.STATES if self.filters["gyro"][0] else _kernel.GYRO_BIAS


class Model(NamedTuple):
    """The step of one epoch as matrices, n states and k measurements."""

    x: Floats
    """(n,)"""
    p: Floats
    """(n, n)"""
    f: Floats
    """(n, n) transition"""
    q: Floats
    """(n, n) process noise"""
    h: Floats
    """(k, n)"""
    r: Floats
    """(k, k) measurement noise"""
    z: Floats
    """(k,) measured less predicted at the point of linearisation, as an error state sees it"""


def _walk(params: Any, filters: Any, epochs: Any, works: Any, n: int) -> None:
    """Predict and update over all epochs, inside machine code."""
    p, m, w = params[0], filters[0], works[0]
    for i in range(epochs.shape[0]):
        e = epochs[i]
        _kernel.predict(p, m, e["period"], n, w)
        _kernel.update(p, m, e, n, w)


def _linearise(params: Any, filters: Any, epochs: Any, works: Any, n: int, f: Any, h: Any, y: Any, noise: Any) -> None:
    """Predict, and fill transition (of a unit matrix), Jacobian, innovations, and noises of the first epoch."""
    p, m, e, w = params[0], filters[0], epochs[0], works[0]
    bank, grade, r = np.empty((2, 2)), np.empty((2, 2)), np.empty((3, 3))
    distance = e["period"] * m["speed"]
    _kernel.road_transition(p["filter_bank_length"], distance, bank)
    _kernel.road_transition(p["filter_grade_length"], distance, grade)
    _kernel.rotation_matrix(m["q_nv"], r)
    _kernel.remember_rows(f, n)
    _kernel.transition_rows(f, 0, n, e["period"], p["filter_mean_share"], distance, r[2].copy(), bank, grade)
    _kernel.predict(p, m, e["period"], n, w)
    z = np.empty(_kernel.MEASUREMENTS)
    _kernel.rotation_matrix(m["q_vs"], r)
    _kernel.predict_measurements(p, m, e, r, z, h, w)
    _kernel.observe(p, m, e, r, y, noise)
    y -= z


walk = njit(nogil=True)(_walk)
linearise = njit(nogil=True)(_linearise)


def usual(filters: NDArray[np.void], epochs: NDArray[np.void]) -> Minute:
    """Give a minute with the measurements the preset `default` takes in motion."""
    return Minute(as_record(core.DEFAULT), filters, epochs)


def fullest(filters: NDArray[np.void], epochs: NDArray[np.void]) -> Minute:
    """Give a minute in which every epoch has every measurement the kernel knows, that of standstill too."""
    noises = replace(
        core.DEFAULT.filter, climb_noise=1.0, course_rate_noise=1.0, standstill_yaw_rate_noise=1.0, altitude_noise=1.0
    )
    epochs = epochs.copy()
    epochs["mean_speed"] = 0.0
    return Minute(as_record(replace(core.DEFAULT, filter=noises)), filters, epochs)


def through(minute: Minute) -> NDArray[np.void]:
    """Give what becomes of the filters in the minute."""
    filters = minute.filters.copy()
    walk(minute.params, filters, minute.epochs, np.zeros(1, _kernel.WORK), minute.states)
    return filters


def model_of(minute: Minute) -> Model:
    """Give the kernel's step over the first epoch as dense matrices."""
    n = minute.states
    f, h = np.eye(_kernel.STATES), np.empty((_kernel.MEASUREMENTS, _kernel.STATES))
    y, noise = np.empty(_kernel.MEASUREMENTS), np.empty(_kernel.MEASUREMENTS)
    certain = minute.filters.copy()
    certain["covariance"] = 0.0
    linearise(minute.params, certain, minute.epochs, np.zeros(1, _kernel.WORK), n, f, h, y, noise)
    seen = np.isfinite(noise)
    q, p = certain["covariance"][0, :n, :n].copy(), minute.filters["covariance"][0, :n, :n].copy()
    return Model(np.zeros(n), p, f[:n, :n].copy(), q, h[seen, :n].copy(), np.diag(noise[seen] ** 2), y[seen])


def numpy_step(x: Floats, p: Floats, model: Model) -> tuple[Floats, Floats]:
    """Predict and update, all measurements at once: the shortest way numpy has."""
    f, h = model.f, model.h
    x = f @ x
    p = f @ p @ f.T + model.q
    ph = p @ h.T
    gain = np.linalg.solve(h @ ph + model.r, ph.T).T
    return x + gain @ (model.z - h @ x), p - gain @ ph.T


def numpy_joseph_step(x: Floats, p: Floats, model: Model) -> tuple[Floats, Floats]:
    """Predict and update in Joseph's form, which filterpy uses."""
    f, h = model.f, model.h
    x = f @ x
    p = f @ p @ f.T + model.q
    ph = p @ h.T
    gain = np.linalg.solve(h @ ph + model.r, ph.T).T
    rest = np.eye(x.size) - gain @ h
    return x + gain @ (model.z - h @ x), rest @ p @ rest.T + gain @ model.r @ gain.T


def filterpy_filter(model: Model) -> KalmanFilter:
    """Give a filter of filterpy with these matrices."""
    kalman = KalmanFilter(model.x.size, model.z.size)
    kalman.x, kalman.P = model.x.copy(), model.p.copy()
    kalman.F, kalman.Q, kalman.H, kalman.R = model.f, model.q, model.h, model.r
    return kalman


def repeat_numpy(step: Any, model: Model, count: int) -> Floats:
    """Make so many steps of numpy."""
    x, p = model.x, model.p
    for _ in range(count):
        x, p = step(x, p, model)
    return p


def repeat_filterpy(model: Model, count: int) -> KalmanFilter:
    """Make so many steps of filterpy."""
    kalman = filterpy_filter(model)
    for _ in range(count):
        kalman.predict()
        kalman.update(model.z)
    return kalman
