"""Two recordings on clocks of their own: how one clock runs on the other, from the motion both devices share.

Neither attitude nor steering angle is known yet, so that only what does not depend on them is compared: the length of
the specific force, and the length of the angular rate, on the wheel without its part along the column.
"""

from typing import NamedTuple

import numpy as np
from scipy.signal import butter, sosfiltfilt

from core.motion.steering_terms import Floats, SteeringError

BAND = (0.1, 4.0)
"""Hz of the shared motion that is compared"""
LEAST_OVERLAP = 20.0
"""s both recordings must have in common"""
LEAST_CORRELATION = 0.25
WINDOW = 60.0
"""s of a piece that shows the offset of its time"""
REACH = 0.5
"""s by which a piece may differ from the whole"""
GAP = 0.5
"""s; a longer gap in a recording is not bridged"""
LARGEST_SKEW = 5e-4


class Clock(NamedTuple):
    """`t_car = offset + (1 + skew) t_wheel`."""

    offset: float
    skew: float
    correlation: float
    """of the shared motion, 1 = the same"""

    def on_car(self, t: Floats) -> Floats:
        """Give times of the wheel's device on the clock of the vehicle's."""
        there: Floats = self.offset + (1 + self.skew) * t
        return there


def averages(t: Floats, x: Floats, raster: Floats) -> Floats:
    """(M, ...) averages of a signal (N, ...) over the cells of an even raster (M,); nan where it has gaps.

    Averages, not samples: vibration beyond the raster's frequency does not fold back into it.
    """
    step = raster[1] - raster[0]
    fresh = np.concatenate([[True], np.diff(t) > 0])
    t, x = t[fresh], x[fresh].reshape(int(fresh.sum()), -1)
    trapezia = np.concatenate([np.zeros((1, x.shape[1])), np.diff(t)[:, None] * (x[1:] + x[:-1]) / 2])
    integral = np.cumsum(trapezia, axis=0)
    edges = np.append(raster - step / 2, raster[-1] + step / 2)
    at = np.stack([np.interp(edges, t, column) for column in integral.T], axis=-1)
    mean: Floats = np.diff(at, axis=0) / step
    after = np.clip(np.searchsorted(t, raster), 1, t.size - 1)
    mean[(raster < t[0]) | (raster > t[-1]) | (t[after] - t[after - 1] > GAP)] = np.nan
    return mean


def even_raster(t: Floats, rate: float) -> Floats:
    """Give an even raster over a recording."""
    return np.arange(np.ceil(t[0] * rate), np.floor(t[-1] * rate) + 1) / rate


def align(car: tuple[Floats, Floats], wheel: tuple[Floats, Floats], rate: float) -> Clock:
    """Find how the clock of the wheel's device runs on the vehicle's.

    Parameters
    ----------
    car, wheel
        times (N,), and (N, C) what both devices feel alike: lengths of the specific force and of the angular rate
    rate
        Hz at which they are compared

    Raises
    ------
    SteeringError
        they have nothing in common.
    """
    rasters = [even_raster(t, rate) for t, _ in (car, wheel)]
    if min(raster.size for raster in rasters) < LEAST_OVERLAP * rate:
        raise SteeringError(f"Both recordings must be at least {LEAST_OVERLAP:.0f} s long.")
    a, b = (_shared(averages(*log, raster), rate) for log, raster in zip((car, wheel), rasters, strict=True))
    lag, correlation = _best_lag(a, b, -b.shape[0], a.shape[0], int(LEAST_OVERLAP * rate))
    if correlation < LEAST_CORRELATION:
        raise SteeringError("The two recordings share no motion: they are not of the same drive, or hardly overlap.")
    offset = rasters[0][0] - rasters[1][0] + lag / rate
    pieces = _pieces(a, b, lag, rate)
    return _line(pieces, rasters[1][0], rasters[0][0] - rasters[1][0], offset, correlation)


def _shared(signals: Floats, rate: float) -> Floats:
    """(M, C) band-passed and brought to unit variance; loud moments are limited."""
    filled = np.nan_to_num(signals - np.nanmedian(signals, axis=0))
    sos = butter(2, BAND, btype="bandpass", fs=rate, output="sos")
    band = sosfiltfilt(sos, filled, axis=0)
    scale = np.median(np.abs(band), axis=0) * 1.5 + 1e-9
    limited: Floats = np.clip(band / scale, -6.0, 6.0)
    return limited


def _best_lag(a: Floats, b: Floats, first: int, last: int, least: int) -> tuple[float, float]:
    """Lag (in samples, a later than b) of the highest correlation, refined by a parabola, and that correlation."""
    size = 1 << int(np.ceil(np.log2(a.shape[0] + b.shape[0])))
    cross = _convolved(a, b, size)
    weight_a, weight_b = (np.ones_like(x[:, :1]) for x in (a, b))
    power_a, power_b = (
        _convolved((a**2).sum(1)[:, None], weight_b, size),
        _convolved(weight_a, (b**2).sum(1)[:, None], size),
    )
    overlap = _convolved(weight_a, weight_b, size)
    lags = np.arange(max(first, 1 - b.shape[0]), min(last, a.shape[0]))
    value = np.where(
        overlap[lags] > least - 0.5, cross[lags] / np.sqrt(np.maximum(power_a[lags] * power_b[lags], 1e-9)), -1.0
    )
    k = int(np.argmax(value))
    return float(lags[k] + _vertex(value, k)), float(value[k])


def _convolved(a: Floats, b: Floats, size: int) -> Floats:
    """Cross-correlation, summed over the channels; negative lags at the end."""
    spectrum = (np.fft.rfft(a, size, axis=0) * np.conj(np.fft.rfft(b, size, axis=0))).sum(axis=1)
    return np.fft.irfft(spectrum, size)


def _vertex(value: Floats, k: int) -> float:
    if not 0 < k < value.size - 1:
        return 0.0
    left, middle, right = value[k - 1 : k + 2]
    bend = left - 2 * middle + right
    return float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5)) if bend < 0 else 0.0


def _pieces(a: Floats, b: Floats, lag: float, rate: float) -> list[tuple[float, float, float]]:
    """(s on b, lag in s, weight) of each piece of a minute."""
    size, reach, found = int(WINDOW * rate), int(REACH * rate), []
    for start in range(0, b.shape[0] - size + 1, size):
        first = start + round(lag) - reach
        if first < 0 or first + size + 2 * reach > a.shape[0]:
            continue
        there, correlation = _best_lag(
            a[first : first + size + 2 * reach], b[start : start + size], 0, 2 * reach + 1, size
        )
        if correlation > LEAST_CORRELATION:
            found.append(((start + size / 2) / rate, (first - start + there) / rate, correlation))
    return found


def _line(
    pieces: list[tuple[float, float, float]], start: float, shift: float, offset: float, correlation: float
) -> Clock:
    """Lay a line through the offsets of the pieces; with fewer than three the clocks are taken to run alike."""
    if len(pieces) < 3:
        return Clock(offset, 0.0, correlation)
    t, lag, weight = np.array(pieces).T
    near = np.abs(lag - np.median(lag)) < 0.1
    if near.sum() < 3:
        return Clock(offset, 0.0, correlation)
    skew, constant = np.polyfit(t[near], lag[near], 1, w=weight[near])
    skew = float(np.clip(skew, -LARGEST_SKEW, LARGEST_SKEW))
    constant = float(np.average(lag[near] - skew * t[near], weights=weight[near] ** 2))
    return Clock(shift + constant - skew * start, skew, correlation)
