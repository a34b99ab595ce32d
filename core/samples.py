"""IMU samples and GPS fixes of one chunk: validated once at the border, trusted afterwards."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

LATITUDE, LONGITUDE, ALTITUDE, SPEED, COURSE, VERTICAL_SPEED, SPEED_ACCURACY, COURSE_ACCURACY = range(8)
"""Columns of `Samples.fix`."""
FIX_COLUMNS = (
    "latitude",  # rad, NaN = not given
    "longitude",  # rad, NaN = not given
    "altitude",  # m, NaN = not given
    "speed",  # m/s over ground, NaN = derive it from the positions
    "course",  # rad clockwise from true north, NaN = derive it from the positions
    "vertical_speed",  # m/s, up positive, NaN = not given
    "speed_accuracy",  # m/s, 1 sigma as the receiver states it, NaN = not given
    "course_accuracy",  # rad, 1 sigma as the receiver states it, NaN = not given
)


_NO_RATES = np.full((1 << 15, 3), np.nan)
"""Shared by all samples without a gyroscope: written for each chunk anew, it would go twice through the memory."""


def no_rates(n: int) -> Floats:
    """Give the angular rates of samples without a gyroscope, (n, 3), all NaN; shared, so never written to."""
    return _NO_RATES[:n] if n <= len(_NO_RATES) else np.full((n, 3), np.nan)


class SampleError(ValueError):
    """Samples that cannot be used; `row` is the index of the first offending IMU sample, if one can be named."""

    def __init__(self, message: str, row: int | None = None) -> None:
        super().__init__(message)
        self.row = row


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of one session in time order. SI units and radians; N IMU samples, M GPS reports."""

    t: Floats
    """(N,) s on the device's monotonic clock of this session, non-decreasing."""
    f_s: Floats
    """(N, 3) m/s2, specific force in the sensor frame."""
    w_s: Floats
    """(N, 3) rad/s, angular rate in the sensor frame; NaN rows where there is no gyroscope reading."""
    fix_row: NDArray[np.int64]
    """(M,) index of the IMU sample each GPS report arrived with, strictly increasing."""
    fix_valid: NDArray[np.bool_]
    """(M,) True for a valid fix, False where the receiver reports that it has none."""
    fix: Floats
    """(M, 8) the fixes, columns as in `FIX_COLUMNS`; NaN for what is not given."""
    m_s: Floats | None = None
    """(N, 3) uT, magnetic field in the sensor frame; NaN rows where there is no reading; None: no magnetometer."""
    steer: Floats | None = None
    """(N,) rad at the steering wheel, positive to the left; NaN where not given; None: no such column."""
    temperature: Floats | None = None
    """(N,) degC of the sensor; as `steer`."""
    pressure: Floats | None = None
    """(N,) Pa of the air; as `steer`."""

    @classmethod
    def make(
        cls,
        t: ArrayLike,
        f_s: ArrayLike,
        w_s: ArrayLike | None = None,
        fix_row: ArrayLike = (),
        fix_valid: ArrayLike = (),
        fix: ArrayLike | None = None,
        m_s: ArrayLike | None = None,
        steer: ArrayLike | None = None,
        temperature: ArrayLike | None = None,
        pressure: ArrayLike | None = None,
    ) -> Self:
        """Convert, check and freeze the arrays of one chunk.

        Raises
        ------
        SampleError
            shapes disagree, time is not finite or runs backwards, an accelerometer reading is not finite,
            fix rows are not strictly increasing indices of samples.
        """
        t_ = np.ascontiguousarray(t, np.float64)
        n = t_.size
        f_s_ = np.ascontiguousarray(f_s, np.float64).reshape(-1, 3)
        w_s_ = no_rates(n) if w_s is None else np.ascontiguousarray(w_s, np.float64).reshape(-1, 3)
        row = np.ascontiguousarray(fix_row, np.int64)
        valid = np.ascontiguousarray(fix_valid, np.bool_)
        fix_ = np.empty((0, 8)) if fix is None else np.ascontiguousarray(fix, np.float64).reshape(-1, 8)
        m_s_ = None if m_s is None else np.ascontiguousarray(m_s, np.float64).reshape(-1, 3)
        others = [None if x is None else np.ascontiguousarray(x, np.float64) for x in (steer, temperature, pressure)]
        if (
            t_.ndim != 1
            or any(x is not None and x.shape[0] != n for x in (f_s_, w_s_, m_s_, *others))
            or not row.shape[0] == valid.shape[0] == fix_.shape[0]
        ):
            raise SampleError("the columns have different lengths")
        _check_finite(t_, "time is not a finite number")
        _check_finite(f_s_, "specific force is not a finite number")
        _check_order(t_)
        if row.size and (row[0] < 0 or row[-1] >= n or np.any(np.diff(row) <= 0)):
            raise SampleError("fix rows must be strictly increasing indices of samples")
        return cls(t_, f_s_, w_s_, row, valid, fix_, m_s_, *others)

    def __len__(self) -> int:
        """Give the number of IMU samples."""
        return int(self.t.size)

    @property
    def has_rates(self) -> bool:
        """True when the gyroscope has told an angular rate."""
        return self.w_s.base is not _NO_RATES and bool(np.isfinite(self.w_s[:, 0]).any())

    def slice(self, start: int, stop: int) -> Self:
        """Give the samples with index in [start, stop), with their fixes; these themselves when that is all of them."""
        if start == 0 and stop == len(self):
            return self
        inside = (self.fix_row >= start) & (self.fix_row < stop)
        return type(self)(
            self.t[start:stop],
            self.f_s[start:stop],
            self.w_s[start:stop],
            self.fix_row[inside] - start,
            self.fix_valid[inside],
            self.fix[inside],
            *(None if x is None else x[start:stop] for x in (self.m_s, self.steer, self.temperature, self.pressure)),
        )


def _check_finite(values: Floats, message: str) -> None:
    with np.errstate(over="ignore", invalid="ignore"):
        if math.isfinite(values.sum()):
            return  # as nearly always, and quicker than looking at each
    odd = np.argwhere(~np.isfinite(values))
    if odd.size:
        raise SampleError(message, int(odd[0, 0]))


def _check_order(t: Floats) -> None:
    back = t[1:] < t[:-1]
    if back.any():
        row = int(np.argmax(back)) + 1
        raise SampleError(f"time runs backwards, from {t[row - 1]:.6g} s to {t[row]:.6g} s", row)
