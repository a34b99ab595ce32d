"""Every numba function of the project: plain loops on records and scratch arrays.

This file imports nothing of the project, so that numba's cache, which watches a single file, can never be stale; record
layouts and parameters arrive as argument types. Records are explained in `state`, parameters in `params`, the method
with its equations in `docs/method.md`. The order here is the order of the flow chart (thesis 6.2).

Abbreviations: `p` parameters, `c` clock, `a` coarse alignment (accumulators), `m` filter, `s` settling, `v`
verification, `g` change; `e` the epoch at hand, `x` the longer one of the coarse alignment;
`w` scratch arrays.
"""

import math
from typing import Any

import numpy as np
from numba import njit

_PLAIN: Any = {"cache": True, "nogil": True, "_nrt": False}
plain = njit(**_PLAIN)
"""For functions that make no arrays: who holds those they are given is not counted, which would take a fifth of the
time. numba has this option for itself alone: where a version has it no longer, leave it out, and all gives the same."""
making = njit(**(_PLAIN | {"_nrt": True}))
"""For the others, which come seldom; to set a slice to an array counts as making one."""

GRAVITY = 9.80665
"""m/s2, standard gravity"""
EARTH_RADIUS = 6371008.8
"""m, mean radius"""
REFERENCE_PERIOD = 0.25
"""s, the epoch for which the thesis gives its noises per step"""
RING_SPACING = 0.1
"""s"""

SLOPE_STEP = 0.15
"""s; how signals change with the latency is seen over twice this time"""
SATURATION_LEVEL = 14.0
"""m/s2; readings that rest at one value above are at the end of the range"""
FLAT_TOP = 2
"""repetitions that make such a rest"""

SPEED, ACCELERATION, YAW_RATE, YAW_RATE_BEFORE, GRADIENT, ATTITUDE, MOUNTING, BIAS = 0, 1, 2, 3, 4, 6, 9, 12
LEVER_ARM, ALTITUDE, LATENCY, SUSPENSION, ANTENNA, GYRO_BIAS = 15, 17, 18, 19, 21, 22
BOUNCE, BOUNCE_BEFORE = 25, 27
"""First index of each part of the error state; those from GYRO_BIAS on are carried only with a gyroscope."""
STATES = 29
MOVED = ((ALTITUDE, ALTITUDE + 1), (GRADIENT, MOUNTING), (SPEED, SPEED + 1))
"""Ranges of rows in which the transition differs from 1, the last first, as `mirror_rows` wants them."""
FORCE, VELOCITY, COURSE_RATE, RATE, STANDSTILL, HEIGHT = 0, 3, 6, 7, 10, 11
"""First row of each measurement: specific force (3), velocity (3), yaw rate from the course, angular rate (3), yaw rate
at standstill, altitude."""
MEASUREMENTS = 12
VELOCITIES, HEIGHTS, FORCES, LATELY = range(4)
"""Kinds of measurements whose noise is learnt; the last is that of the velocity over the last seconds."""

DUPLICATE_TIME, BEFORE_PREVIOUS, FIX_WITHOUT_VELOCITY, FIX_IMPLAUSIBLE = range(4)
"""Reasons of rejection."""

NO_EPOCH, BROKEN, OUTAGE, COMPLETE = range(4)
"""What a fix makes of the epoch before it."""

IDLE, WATCHING, SUSPICIOUS = range(3)
"""States of the watch for an orientation change."""
MOST_EVIDENCE = 1e6
"""Largest value kept of the evidence series."""

STARTED, PASSED, FAILED, CONFIRMED, CHANGED, FAULT = range(6)
"""Event codes."""
LEFT_HANDED, STUCK_AXIS, SATURATED, LOOSE = range(4)
"""Faults."""
REASON_NONE, REASON_DRIVE_TEST, REASON_SECOND_OPINION, REASON_MOVED_ON, REASON_UNSURE = range(5)

EPOCH = np.dtype(
    [
        ("t", "f8"),  # s, its end
        ("period", "f8"),  # s
        ("speed", "f8"),  # m/s at its end
        ("mean_speed", "f8"),
        ("speed_change", "f8"),
        ("speed_noise", "f8"),  # m/s, per horizontal axis
        ("course", "f8"),  # rad at its end, nan = not trusted
        ("yaw_rate", "f8"),  # rad/s from the course, nan = not known
        ("lateral", "f8"),  # m/s2, speed times yaw rate
        ("altitude", "f8"),  # m as received, nan = none
        ("vertical_speed", "f8"),  # m/s as received, nan = none
        ("climb", "f8"),  # m/s from the smoothed altitude, nan = no altitude
        ("grade", "f8"),  # sine of the slope
        ("moving", "?"),
        ("usable", "?"),
        ("f_s", "f8", (3,)),  # mean specific force at the latency of the filter
        ("w_s", "f8", (3,)),
        ("f_slope", "f8", (3,)),  # its change with time, m/s3
        ("w_slope", "f8", (3,)),
        ("gyro", "?"),
        ("flat_tops", "i8"),  # samples at the end of the range
        ("next_speed", "f8"),  # of the last fix, which ends it and begins the next, nan = not known
        ("next_course", "f8"),
        ("tested_speed", "f8"),  # m/s at its end, by the sensor under the mounting on the drive test, nan = not told
        ("test_begins", "?"),  # the first that is told of a test
    ]
)
"""One epoch, the scratch record that passes from the clock to the stages."""

MERGED = np.dtype(
    [
        ("start", "f8"),  # s
        ("period", "f8"),  # s
        ("mean_speed", "f8"),
        ("speed_change", "f8"),
        ("yaw_rate", "f8"),
        ("lateral", "f8"),
        ("grade", "f8"),
        ("f_s", "f8", (9, 3)),  # mean specific force, per latency hypothesis
        ("w_s", "f8", (9, 3)),
        ("gyro", "?"),
    ]
)
"""The longer epoch of the coarse alignment."""

WORK = np.dtype(
    [
        ("begin", "f8", (8,)),  # integrals, and the time without gyroscope behind them
        ("stop", "f8", (8,)),
        ("velocity", "f8", (2,)),  # speed and course of a fix
        ("slopes", "f8", (4, 3)),
        ("k", "f8", (3,)),
        ("sigma", "f8", (3,)),
        ("b", "f8", (3, 3)),  # profile matrix
        ("r_vs", "f8", (3, 3)),
        ("r_nv", "f8", (3, 3)),
        ("r_turned", "f8", (3, 3)),
        ("turn", "f8", (3, 3)),
        ("bank", "f8", (2, 2)),
        ("grade", "f8", (2, 2)),
        ("up", "f8", (3,)),
        ("partials", "f8", (5, GYRO_BIAS)),
        ("z", "f8", (MEASUREMENTS,)),  # predicted
        ("y", "f8", (MEASUREMENTS,)),  # measured
        ("noise", "f8", (MEASUREMENTS,)),
        ("h", "f8", (MEASUREMENTS, STATES)),
        ("dx", "f8", (STATES,)),
        ("ph", "f8", (STATES,)),
        ("mean", "f8", (4,)),
        ("d", "f8", (3,)),
        ("total", "f8", (3, 3)),
    ]
)
"""Scratch arrays, which mean nothing from one function to the next: allocated here, counting who holds them would take
a third of the time."""


# ---------------------------------------------------------------------------------------------------- rotations


@plain
def rotation_matrix(q, r):
    """R = R(q), thesis (C.3) with the scalar first."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    r[0, 0] = 1 - 2 * (y * y + z * z)
    r[0, 1] = 2 * (x * y - w * z)
    r[0, 2] = 2 * (x * z + w * y)
    r[1, 0] = 2 * (x * y + w * z)
    r[1, 1] = 1 - 2 * (x * x + z * z)
    r[1, 2] = 2 * (y * z - w * x)
    r[2, 0] = 2 * (x * z - w * y)
    r[2, 1] = 2 * (y * z + w * x)
    r[2, 2] = 1 - 2 * (x * x + y * y)


@plain
def turn(q, x, y, z):
    """Q = dq(a) * q with the Rodrigues vector a = (x, y, z), thesis (4.24) and (4.26)."""
    n = 1.0 / math.sqrt(4.0 + x * x + y * y + z * z)
    w, x, y, z = 2 * n, x * n, y * n, z * n
    q0 = w * q[0] - x * q[1] - y * q[2] - z * q[3]
    q1 = w * q[1] + x * q[0] + y * q[3] - z * q[2]
    q2 = w * q[2] - x * q[3] + y * q[0] + z * q[1]
    q3 = w * q[3] + x * q[2] - y * q[1] + z * q[0]
    n = 1.0 / math.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    q[0] = q0 * n
    q[1] = q1 * n
    q[2] = q2 * n
    q[3] = q3 * n


@plain
def turn_right(q, x, y, z):
    """Q = q * dq(a): the Rodrigues vector a = (x, y, z) in the axes that q turns from."""
    n = 1.0 / math.sqrt(4.0 + x * x + y * y + z * z)
    w, x, y, z = 2 * n, x * n, y * n, z * n
    q0 = q[0] * w - q[1] * x - q[2] * y - q[3] * z
    q1 = q[0] * x + q[1] * w + q[2] * z - q[3] * y
    q2 = q[0] * y - q[1] * z + q[2] * w + q[3] * x
    q3 = q[0] * z + q[1] * y - q[2] * x + q[3] * w
    n = 1.0 / math.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    q[0] = q0 * n
    q[1] = q1 * n
    q[2] = q2 * n
    q[3] = q3 * n


@plain
def difference(q, p, d):
    """D = rotation vector of q * p^-1, rad."""
    w = q[0] * p[0] + q[1] * p[1] + q[2] * p[2] + q[3] * p[3]
    d[0] = -q[0] * p[1] + q[1] * p[0] - q[2] * p[3] + q[3] * p[2]
    d[1] = -q[0] * p[2] + q[1] * p[3] + q[2] * p[0] - q[3] * p[1]
    d[2] = -q[0] * p[3] - q[1] * p[2] + q[2] * p[1] + q[3] * p[0]
    sine = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    scale = 2.0
    if sine > 1e-12:
        scale = 2 * math.atan2(sine, abs(w)) / sine
    if w < 0:
        scale = -scale
    for i in range(3):
        d[i] *= scale


@plain
def wrap(angle):
    """Angle in [-pi, pi)."""
    return angle - 2 * math.pi * np.floor((angle + math.pi) / (2 * math.pi))


@plain
def mahalanobis(d, covariance):
    """D' C^-1 d for three components (Cholesky)."""
    l00 = math.sqrt(covariance[0, 0])
    l10 = covariance[1, 0] / l00
    l20 = covariance[2, 0] / l00
    l11 = math.sqrt(max(covariance[1, 1] - l10 * l10, 1e-30))
    l21 = (covariance[2, 1] - l20 * l10) / l11
    l22 = math.sqrt(max(covariance[2, 2] - l20 * l20 - l21 * l21, 1e-30))
    x = d[0] / l00
    y = (d[1] - l10 * x) / l11
    z = (d[2] - l20 * x - l21 * y) / l22
    return x * x + y * y + z * z


# ------------------------------------------------------------------------------------------------ clock and epochs


@plain
def begin_chain(c, t):
    """Start the integrated signal anew: after a gap nothing older may be averaged."""
    c["integral"][:] = 0.0
    c["ring_count"] = 0
    c["ring_head"] = -1
    c["fix_t"] = np.nan
    push_point(c, t)


@plain
def push_point(c, t):
    """Keep the integral at time t in the ring."""
    size = c["ring_t"].shape[0]
    head = (c["ring_head"] + 1) % size
    c["ring_head"] = head
    c["ring_count"] = min(c["ring_count"] + 1, size)
    c["ring_t"][head] = t
    for j in range(7):
        c["ring"][head, j] = c["integral"][j]


@plain
def integrate(p, c, t, f_s, w_s, first, stop, counts):
    """Take IMU samples up to `stop` or until a report is due; gives the index after the last one taken.

    Trapezoidal integral, a point in the ring every 0.1 s. Plain local numbers, the sums too, which go where others
    find them when a point is due: this is where the time goes.
    """
    now, report, gap = c["t"], c["next_report"], p["epoch_max_sample_gap"]
    point = c["ring_t"][c["ring_head"]] + RING_SPACING - 1e-9
    fx, fy, fz = c["f_s"][0], c["f_s"][1], c["f_s"][2]
    wx, wy, wz, blind = c["w_s"][0], c["w_s"][1], c["w_s"][2], c["no_gyro"]
    total, repeated = c["integral"], True
    t0, t1, t2, t3, t4, t5, t6 = total[0], total[1], total[2], total[3], total[4], total[5], total[6]
    i = first
    while i < stop:
        time = t[i]
        if time <= now:
            c["samples"] -= 1
            counts[DUPLICATE_TIME if time == now else BEFORE_PREVIOUS] += 1
            i += 1
            continue
        x, y, z = f_s[i, 0], f_s[i, 1], f_s[i, 2]
        u, v, w = w_s[i, 0], w_s[i, 1], w_s[i, 2]
        no_gyro = 0.0
        if not math.isfinite(u + v + w):
            u = v = w = 0.0
            no_gyro = 1.0
        half = 0.5 * (time - now)
        chained = half <= 0.5 * gap  # False for nan, the first sample of a session
        if chained:
            t0 += half * (fx + x)
            t1 += half * (fy + y)
            t2 += half * (fz + z)
            t3 += half * (wx + u)
            t4 += half * (wy + v)
            t5 += half * (wz + w)
            t6 += half * (blind + no_gyro)
            if x == fx or y == fy or z == fz:
                watch_repeats(c, x == fx, y == fy, z == fz, x, y, z)
                repeated = True
            elif repeated:
                c["repeats"][:] = 0
                repeated = False
        fx, fy, fz, wx, wy, wz, blind, now = x, y, z, u, v, w, no_gyro, time
        if not chained:
            begin_chain(c, time)
            t0 = t1 = t2 = t3 = t4 = t5 = t6 = 0.0
            point = time + RING_SPACING - 1e-9
        elif time >= point:
            total[0], total[1], total[2], total[3], total[4], total[5], total[6] = t0, t1, t2, t3, t4, t5, t6
            push_point(c, time)
            point = time + RING_SPACING - 1e-9
        i += 1
        if not time < report:
            break
    total[0], total[1], total[2], total[3], total[4], total[5], total[6] = t0, t1, t2, t3, t4, t5, t6
    c["samples"] += i - first
    c["t"], c["no_gyro"] = now, blind
    c["f_s"][0], c["f_s"][1], c["f_s"][2] = fx, fy, fz
    c["w_s"][0], c["w_s"][1], c["w_s"][2] = wx, wy, wz
    return i


@plain
def watch_repeats(c, same_x, same_y, same_z, x, y, z):
    """Count how long each axis repeats itself, and the samples that rest at the end of the range."""
    c["repeats"][0] = c["repeats"][0] + 1 if same_x else 0
    c["repeats"][1] = c["repeats"][1] + 1 if same_y else 0
    c["repeats"][2] = c["repeats"][2] + 1 if same_z else 0
    rest = (
        (c["repeats"][0] >= FLAT_TOP and abs(x) > SATURATION_LEVEL)
        or (c["repeats"][1] >= FLAT_TOP and abs(y) > SATURATION_LEVEL)
        or (c["repeats"][2] >= FLAT_TOP and abs(z) > SATURATION_LEVEL)
    )
    if rest:
        c["flat_tops"] += 1


@plain
def integral_at(c, t, out):
    """Integral at time t, linear between the points of the ring; False when t is not covered."""
    size, head, count = c["ring_t"].shape[0], c["ring_head"], c["ring_count"]
    newest = c["ring_t"][head]
    if t >= newest:
        span = c["t"] - newest
        weight = 0.0 if span <= 0 else min((t - newest) / span, 1.0)
        for j in range(7):
            out[j] = c["ring"][head, j] + weight * (c["integral"][j] - c["ring"][head, j])
        return True
    back = min(int((newest - t) / RING_SPACING) + 1, count - 1)  # points are at least so far apart
    if c["ring_t"][(head - back) % size] > t:
        return False
    while back > 1 and c["ring_t"][(head - back + 1) % size] <= t:
        back -= 1
    earlier, later = (head - back) % size, (head - back + 1) % size
    weight = (t - c["ring_t"][earlier]) / (c["ring_t"][later] - c["ring_t"][earlier])
    for j in range(7):
        out[j] = c["ring"][earlier, j] + weight * (c["ring"][later, j] - c["ring"][earlier, j])
    return True


@plain
def mean_signals(c, start, end, delay, f_s, w_s, w):
    """Mean specific force and angular rate of [start, end] that many seconds ago: False when not covered.

    The end is now; for no delay the integral at the fix that began the epoch is known exactly.
    """
    begin, stop = w["begin"], w["stop"]
    if delay == 0.0 and abs(start - c["fix_t"]) < 1e-9:
        for j in range(7):
            begin[j], stop[j] = c["fix_integral"][j], c["integral"][j]
    elif not (integral_at(c, start - delay, begin) and integral_at(c, end - delay, stop)):
        return False
    for j in range(3):
        f_s[j] = (stop[j] - begin[j]) / (end - start)
        w_s[j] = (stop[3 + j] - begin[3 + j]) / (end - start)
    begin[7] = stop[6] - begin[6]
    return True


@plain
def delayed_signals(p, c, delay, e, w):
    """Mean signals of the epoch at the latency `delay` and how they change with it; False when not covered."""
    start, end = e["t"] - e["period"], e["t"]
    low, high = max(delay - SLOPE_STEP, 0.0), delay + SLOPE_STEP
    if p["epoch_latency_count"] > 1:
        f_low, f_high, w_low, w_high = w["slopes"][0], w["slopes"][1], w["slopes"][2], w["slopes"][3]
        if not (
            mean_signals(c, start, end, low, f_low, w_low, w) and mean_signals(c, start, end, high, f_high, w_high, w)
        ):
            return False
        for i in range(3):
            e["f_slope"][i] = (f_low[i] - f_high[i]) / (high - low)
            e["w_slope"][i] = (w_low[i] - w_high[i]) / (high - low)
    covered = mean_signals(c, start, end, delay, e["f_s"], e["w_s"], w)
    e["gyro"] = w["begin"][7] == 0.0 and math.isfinite(p["filter_gyro_noise"])
    return covered


@plain
def velocity_of_fix(p, c, t, fix, velocity):
    """Speed and course of a fix, from its positions where the receiver gives none; False when there is neither."""
    speed, course = fix[3], fix[4]
    known = math.isfinite(fix[0]) and math.isfinite(fix[1])
    dt = t - c["position_t"]
    if known and 0 < dt <= p["epoch_max_epoch"] and not (math.isfinite(speed) and math.isfinite(course)):
        north = (fix[0] - c["latitude"]) * EARTH_RADIUS
        east = (fix[1] - c["longitude"]) * EARTH_RADIUS * math.cos(fix[0])
        if not math.isfinite(speed):
            speed = math.hypot(north, east) / dt
        if not math.isfinite(course) and speed > p["epoch_moving_speed"]:
            course = math.atan2(east, north)
    if known:
        c["position_t"] = t
        c["latitude"] = fix[0]
        c["longitude"] = fix[1]
    velocity[0] = speed
    velocity[1] = course
    return math.isfinite(speed)


@plain
def stated_noise(p, fix):
    """Velocity noise per horizontal axis, m/s: what the receiver states, within reason, else the usual one."""
    along, across = fix[6], fix[7] * fix[3]
    if not math.isfinite(along):
        along = across
    if not math.isfinite(across):
        across = along
    if not math.isfinite(along):
        return p["filter_speed_noise"]
    return min(max(math.sqrt(0.5 * (along * along + across * across)), 0.5 * p["filter_speed_noise"]), 10.0)


@plain
def smooth_altitude(p, c, t, fix):
    """Critically damped tracking of altitude and climb rate; a receiver's vertical speed is taken as it is."""
    if math.isfinite(fix[5]):
        c["climb"] = fix[5]
    if not math.isfinite(fix[2]):
        return
    dt = t - c["altitude_t"]
    predicted = c["altitude"] + c["climb"] * dt
    residual = fix[2] - predicted
    if not dt <= 10.0 or not abs(residual) <= 30.0:
        c["altitude"] = fix[2]
        c["climb"] = 0.0
    elif dt > 0:
        decay = 0.0
        if p["epoch_altitude_time_constant"] > 0:
            decay = math.exp(-dt / p["epoch_altitude_time_constant"])
        c["altitude"] = predicted + (1 - decay * decay) * residual
        if not math.isfinite(fix[5]):
            c["climb"] += (1 - decay) * (1 - decay) * residual / dt
    c["altitude_t"] = t


@plain
def watch_direction(p, c, speed, course):
    """Reversing shows as a course that jumps by about 180 deg while the vehicle is slow."""
    if speed < p["epoch_moving_speed"]:
        c["slow_since"] = True
    elif math.isfinite(course) and speed > 1.5 * p["epoch_moving_speed"]:
        if c["slow_since"] and p["epoch_detect_reversing"] and abs(wrap(course - c["travel_course"])) > 2.0:
            c["reversing"] = not c["reversing"]
        c["slow_since"] = False
        c["travel_course"] = course
    if speed > p["epoch_reversing_speed"]:
        c["reversing"] = False


@plain
def start_epoch(c, t, speed, course):
    """Let the next epoch begin at this fix."""
    c["fix_t"] = t
    c["fix_speed"] = speed
    c["fix_course"] = course
    for j in range(7):
        c["fix_integral"][j] = c["integral"][j]
    c["flat_tops"] = 0
    c["samples"] = 0


@plain
def describe_epoch(p, c, e, t, speed, course, fix):
    """Kinematics between the fix that began the epoch and this one; False when it is a jump."""
    period = t - c["fix_t"]
    e["t"] = t
    e["period"] = period
    e["speed"] = speed
    e["mean_speed"] = 0.5 * (speed + c["fix_speed"])
    e["speed_change"] = speed - c["fix_speed"]
    e["speed_noise"] = stated_noise(p, fix)
    slow = min(speed, c["fix_speed"]) < p["epoch_moving_speed"]
    e["moving"] = not slow
    e["course"] = np.nan if (slow and not p["filter_low_speed_course"]) else course
    e["yaw_rate"] = -wrap(course - c["fix_course"]) / period
    if slow and not p["filter_low_speed_course"]:
        e["yaw_rate"] = np.nan
    e["lateral"] = e["mean_speed"] * e["yaw_rate"]
    e["altitude"] = fix[2]
    e["vertical_speed"] = fix[5]
    e["climb"] = c["climb"] if math.isfinite(c["altitude"]) else np.nan
    e["grade"] = 0.0
    if math.isfinite(e["climb"]) and e["mean_speed"] > 3 * p["epoch_moving_speed"]:
        e["grade"] = min(max(e["climb"] / e["mean_speed"], -0.2), 0.2)
    jump = abs(e["speed_change"]) > p["epoch_max_acceleration"] * period
    return not (jump or (e["moving"] and abs(e["yaw_rate"]) > p["epoch_max_yaw_rate"]))


@plain
def take_fix(p, c, e, t, fix, counts, w):
    """Turn a valid fix into an epoch: whether one has ended, and whether `e` holds it whole."""
    c["valid_fix_t"] = t
    e["next_speed"] = np.nan
    velocity = w["velocity"]
    if not velocity_of_fix(p, c, t, fix, velocity):
        counts[FIX_WITHOUT_VELOCITY] += 1
        return NO_EPOCH
    speed, course = velocity[0], velocity[1]
    if speed < 0 or speed > p["epoch_max_speed"]:
        counts[FIX_IMPLAUSIBLE] += 1
        return NO_EPOCH
    e["next_speed"] = speed
    e["next_course"] = course
    period = t - c["fix_t"]
    if period < p["epoch_min_epoch"]:
        return NO_EPOCH
    smooth_altitude(p, c, t, fix)
    watch_direction(p, c, speed, course)
    if speed >= p["epoch_moving_speed"]:
        c["motion_t"] = t
    if not period <= p["epoch_max_epoch"]:
        return OUTAGE
    if not describe_epoch(p, c, e, t, speed, course, fix):
        counts[FIX_IMPLAUSIBLE] += 1
        return BROKEN
    e["usable"] = not c["reversing"] and c["flat_tops"] == 0
    e["flat_tops"] = c["flat_tops"]
    e["tested_speed"] = np.nan
    return COMPLETE


# ------------------------------------------------------------------------------------------------ coarse alignment


@plain
def merge_epoch(p, c, x, e, w):
    """Merge an epoch into the longer one `x` that the coarse alignment uses; True when that is complete.

    The noise of a speed difference counts less the longer the epoch, and driving shows little above 1 Hz.
    """
    if x["period"] >= p["coarse_min_epoch"]:
        x["period"] = 0.0
    if x["period"] == 0.0:
        x["start"] = e["t"] - e["period"]
        x["speed_change"] = 0.0
    before = x["period"] / (x["period"] + e["period"])
    x["speed_change"] += e["speed_change"]
    x["period"] += e["period"]
    x["mean_speed"] = mixed(before, x["mean_speed"], e["mean_speed"])
    x["yaw_rate"] = mixed(before, x["yaw_rate"], e["yaw_rate"])
    x["lateral"] = mixed(before, x["lateral"], e["lateral"])
    x["grade"] = mixed(before, x["grade"], e["grade"])
    if x["period"] < p["coarse_min_epoch"]:
        return False
    missing = 0.0
    for h in range(p["epoch_latency_count"]):
        delay = h * p["epoch_latency_step"]
        if not mean_signals(c, x["start"], e["t"], delay, x["f_s"][h], x["w_s"][h], w):
            return False
        missing += w["begin"][7]
    x["gyro"] = missing == 0.0
    return True


@plain
def mixed(share, x, y):
    """Mean of x and y, x with the given share."""
    return y if share == 0 else share * x + (1 - share) * y


@plain
def kinematics(x, k):
    """Kinematic specific force k_v of an epoch in motion."""
    k[0] = x["speed_change"] / x["period"] + GRAVITY * x["grade"]
    k[1] = x["lateral"]
    k[2] = GRAVITY


@plain
def accumulate(p, a, x, k, first, count):
    """Add an epoch in motion to the sums, for the latency hypotheses from `first` on."""
    weight = x["period"]
    a["time"] += weight
    for i in range(3):
        a["k"][i] += weight * k[i]
        for j in range(3):
            a["kk"][i, j] += weight * k[i] * k[j]
    for h in range(first, first + count):
        for i in range(3):
            f = x["f_s"][h, i]
            a["f"][h, i] += weight * f
            a["ff"][h] += weight * f * f
            for j in range(3):
                a["fk"][h, i, j] += weight * f * k[j]
    if x["gyro"] and math.isfinite(p["coarse_gyro_noise_density"]):
        accumulate_gyro(p, a, x, weight, first, count)


@plain
def accumulate_gyro(p, a, x, weight, first, count):
    """Add the pair angular rate, yaw rate from the course, which is the noisier the slower the vehicle."""
    rate = x["yaw_rate"]
    course_noise = 2 * (p["filter_speed_noise"] / x["mean_speed"]) ** 2 / x["period"]
    weight *= p["coarse_gyro_noise_density"] / (p["coarse_gyro_noise_density"] + course_noise)
    a["gyro_time"] += weight
    a["r"] += weight * rate
    a["rr"] += weight * rate * rate
    for h in range(first, first + count):
        for i in range(3):
            w = x["w_s"][h, i]
            a["w"][h, i] += weight * w
            a["wr"][h, i] += weight * w * rate
            a["ww"][h] += weight * w * w


@plain
def clear_sums(a):
    """Empty the accumulators of a coarse alignment; latency and noise stay known."""
    a["time"] = a["gyro_time"] = a["r"] = a["rr"] = 0.0
    a["k"][:] = 0.0
    a["kk"][:] = 0.0
    a["f"][:] = 0.0
    a["fk"][:] = 0.0
    a["ff"][:] = 0.0
    a["w"][:] = 0.0
    a["wr"][:] = 0.0
    a["ww"][:] = 0.0
    a["solved_time"] = np.nan


@plain
def profile_matrix(a, h, prior, noise, gyro_noise, b):
    """B = sum of f_s k_v' with the bias eliminated, in units of information; gives the sum of squares beside it."""
    n = a["time"] + prior
    total = a["ff"][h]
    for i in range(3):
        total += a["kk"][i, i] - (a["f"][h, i] * a["f"][h, i] + a["k"][i] * a["k"][i]) / n
        for j in range(3):
            b[i, j] = (a["fk"][h, i, j] - a["f"][h, i] * a["k"][j] / n) / noise
    total /= noise
    if a["gyro_time"] > 0 and math.isfinite(gyro_noise):
        n = a["gyro_time"]
        square = a["ww"][h] + a["rr"] - a["r"] * a["r"] / n
        for i in range(3):
            square -= a["w"][h, i] * a["w"][h, i] / n
            b[i, 2] += (a["wr"][h, i] - a["w"][h, i] * a["r"] / n) / gyro_noise
        total += square / gyro_noise
    return total


@plain
def horn_matrix(b, n):
    """Horn's symmetric 4x4 matrix of B: the quaternion with k ~ R(q) f is its eigenvector of the largest eigenvalue."""
    n[0, 0] = b[0, 0] + b[1, 1] + b[2, 2]
    n[1, 1] = b[0, 0] - b[1, 1] - b[2, 2]
    n[2, 2] = -b[0, 0] + b[1, 1] - b[2, 2]
    n[3, 3] = -b[0, 0] - b[1, 1] + b[2, 2]
    n[0, 1] = n[1, 0] = b[1, 2] - b[2, 1]
    n[0, 2] = n[2, 0] = b[2, 0] - b[0, 2]
    n[0, 3] = n[3, 0] = b[0, 1] - b[1, 0]
    n[1, 2] = n[2, 1] = b[0, 1] + b[1, 0]
    n[1, 3] = n[3, 1] = b[2, 0] + b[0, 2]
    n[2, 3] = n[3, 2] = b[1, 2] + b[2, 1]


@plain
def determinant3(a, b, c, d, e, f, g, h, i):
    """Determinant of a 3x3 matrix given row by row."""
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


@plain
def largest_eigenvalue(b, n):
    """Largest eigenvalue of Horn's matrix, by Newton's method on its characteristic polynomial (QUEST).

    l^4 - 2 |B|^2 l^2 - 8 det(B) l + det(N); from above, where the method descends to the largest root.
    """
    square = 0.0
    for i in range(3):
        for j in range(3):
            square += b[i, j] * b[i, j]
    if square <= 0.0:
        return 0.0
    det = determinant3(b[0, 0], b[0, 1], b[0, 2], b[1, 0], b[1, 1], b[1, 2], b[2, 0], b[2, 1], b[2, 2])
    constant = 0.0
    for i in range(4):
        constant += n[0, i] * cofactor(n, 0, i, 0.0)
    value = math.sqrt(3.0 * square)
    for _ in range(60):
        slope = 4 * value * (value * value - square) - 8 * det
        height = ((value * value - 2 * square) * value - 8 * det) * value + constant
        if slope <= 0.0:
            break
        step = height / slope
        value -= step
        if abs(step) < 1e-14 * value:
            break
    return value


@plain
def cofactor(n, row, column, value):
    """Cofactor of N - value * 1."""
    i, j, k = others(row)
    u, v, w = others(column)
    det = determinant3(
        shifted(n, i, u, value), shifted(n, i, v, value), shifted(n, i, w, value),
        shifted(n, j, u, value), shifted(n, j, v, value), shifted(n, j, w, value),
        shifted(n, k, u, value), shifted(n, k, v, value), shifted(n, k, w, value),
    )  # fmt: skip
    return -det if (row + column) % 2 else det


@plain
def others(index):
    """The three of 0 to 3 that are not `index`."""
    return 1 if index < 1 else 0, 2 if index < 2 else 1, 3 if index < 3 else 2


@plain
def shifted(n, i, j, value):
    """Element of N - value * 1."""
    return n[i, j] - value if i == j else n[i, j]


@making
def best_rotation(b, q):
    """Wahba's problem: k ~ R(q) f for B = sum f k'; gives the largest eigenvalue.

    The eigenvector is the column of the adjugate of N - l 1 with the largest diagonal.
    """
    n = np.empty((4, 4))
    horn_matrix(b, n)
    value = largest_eigenvalue(b, n)
    column, largest = 0, -1.0
    for i in range(4):
        size = abs(cofactor(n, i, i, value))
        if size > largest:
            column, largest = i, size
    norm = 0.0
    for i in range(4):
        q[i] = cofactor(n, i, column, value)
        norm += q[i] * q[i]
    if norm <= 0.0:
        q[:] = 0.0
        q[0] = norm = 1.0
    scale = (-1.0 if q[0] < 0 else 1.0) / math.sqrt(norm)
    for i in range(4):
        q[i] *= scale
    return value


@making
def mirror_evidence(p, a, noise, b):
    """How much better a mirror image explains the accelerations than any rotation does: log of the likelihood ratio.

    The best reflection of B is the best rotation of -B. Each is tried at its own best latency, because mirrored axes
    make a wrong latency look good.
    """
    n = np.empty((4, 4))
    rotation, reflection = np.inf, np.inf
    for h in range(p["epoch_latency_count"]):
        total = profile_matrix(a, h, noise / p["coarse_bias_sigma"] ** 2, noise, np.inf, b)
        total += ((h * p["epoch_latency_step"] - p["coarse_latency"]) / p["coarse_latency_sigma"]) ** 2
        horn_matrix(b, n)
        rotation = min(rotation, total - 2 * largest_eigenvalue(b, n))
        for i in range(3):
            for j in range(3):
                b[i, j] = -b[i, j]
        horn_matrix(b, n)
        reflection = min(reflection, total - 2 * largest_eigenvalue(b, n))
    return 0.5 * (rotation - reflection)


@plain
def invert_information(info, covariance):
    """Inverse of a symmetric 3x3 matrix; a ridge keeps directions without information finite."""
    for i in range(3):
        info[i, i] += 1e-2
    c00 = info[1, 1] * info[2, 2] - info[1, 2] * info[1, 2]
    c01 = info[0, 2] * info[1, 2] - info[0, 1] * info[2, 2]
    c02 = info[0, 1] * info[1, 2] - info[0, 2] * info[1, 1]
    det = info[0, 0] * c00 + info[0, 1] * c01 + info[0, 2] * c02
    covariance[0, 0] = c00 / det
    covariance[0, 1] = covariance[1, 0] = c01 / det
    covariance[0, 2] = covariance[2, 0] = c02 / det
    covariance[1, 1] = (info[0, 0] * info[2, 2] - info[0, 2] * info[0, 2]) / det
    covariance[1, 2] = covariance[2, 1] = (info[0, 1] * info[0, 2] - info[0, 0] * info[1, 2]) / det
    covariance[2, 2] = (info[0, 0] * info[1, 1] - info[0, 1] * info[0, 1]) / det


@making
def coarse_covariance(a, prior, noise, gyro_noise, covariance):
    """Covariance of the solution: inverse of (tr(M) 1 - M) / S with M the scatter of k_v, bias eliminated."""
    info = np.zeros((3, 3))
    n = a["time"] + prior
    trace = 0.0
    for i in range(3):
        trace += a["kk"][i, i] - a["k"][i] * a["k"][i] / n
    for i in range(3):
        info[i, i] = trace / noise
        for j in range(3):
            info[i, j] -= (a["kk"][i, j] - a["k"][i] * a["k"][j] / n) / noise
    if a["gyro_time"] > 0 and math.isfinite(gyro_noise):
        scatter = (a["rr"] - a["r"] * a["r"] / a["gyro_time"]) / gyro_noise
        info[0, 0] += scatter
        info[1, 1] += scatter
    invert_information(info, covariance)


@making
def choose_latency(p, a, prior, noise, gyro_noise):
    """The hypothesis with the smallest residual, refined by a parabola through its neighbours; gives that residual."""
    count = p["epoch_latency_count"]
    b = np.empty((3, 3))
    q = np.empty(4)
    costs = np.empty(count)
    for h in range(count):
        costs[h] = profile_matrix(a, h, prior, noise, gyro_noise, b)
        costs[h] -= 2 * best_rotation(b, q)
        delay = h * p["epoch_latency_step"]
        costs[h] += ((delay - p["coarse_latency"]) / p["coarse_latency_sigma"]) ** 2
    best = 0
    for h in range(1, count):
        if costs[h] < costs[best]:
            best = h
    offset = 0.0
    if 0 < best < count - 1:
        curvature = costs[best - 1] - 2 * costs[best] + costs[best + 1]
        if curvature > 0:
            offset = 0.5 * (costs[best - 1] - costs[best + 1]) / curvature
    for h in range(count):
        a["costs"][h] = costs[h] - costs[best]
    a["hypothesis"] = best
    a["latency"] = (best + offset) * p["epoch_latency_step"]
    return costs[best]


@making
def solve_coarse(p, a, b, choose):
    """Solve the weighted Procrustes problem: mounting, bias, covariance, noise density and latency."""
    noise = a["noise_density"]
    floor = p["coarse_min_noise"] ** 2 * p["coarse_correlation_time"]
    if noise <= 0:
        noise = 4 * floor
    prior = noise / p["coarse_bias_sigma"] ** 2
    gyro_noise = p["coarse_gyro_noise_density"]
    if choose:
        choose_latency(p, a, prior, noise, gyro_noise)
    h = a["hypothesis"]
    profile_matrix(a, h, prior, noise, gyro_noise, b)
    best_rotation(b, a["q_vs"])
    coarse_covariance(a, prior, noise, gyro_noise, a["covariance"])
    r = np.empty((3, 3))
    rotation_matrix(a["q_vs"], r)
    n = a["time"] + prior
    residual = a["ff"][h]
    for j in range(3):
        predicted = r[0, j] * a["k"][0] + r[1, j] * a["k"][1] + r[2, j] * a["k"][2]
        a["bias"][j] = (a["f"][h, j] - predicted) / n
        residual += a["kk"][j, j] - n * a["bias"][j] * a["bias"][j]
        for i in range(3):
            residual -= 2 * r[i, j] * a["fk"][h, j, i]
    variance = residual / (3 * a["time"])
    a["noise_density"] = max(variance * p["coarse_correlation_time"], floor)
    a["solved_time"] = a["time"]


@plain
def update_coarse(p, a, e, k, b):
    """Accumulate an epoch in motion and solve again once in a while; True when there is a new solution."""
    accumulate(p, a, e, k, 0, p["epoch_latency_count"])
    since = a["time"] - a["solved_time"]
    if a["time"] < p["coarse_min_time"] or since < p["coarse_interval"]:
        return False
    interval = p["coarse_interval"]
    choose = p["epoch_latency_count"] > 1 and math.floor(a["time"] / (5 * interval)) != math.floor(
        (a["time"] - e["period"]) / (5 * interval)
    )
    solve_coarse(p, a, b, choose or not math.isfinite(a["solved_time"]))
    if choose:  # with the usual noise: mirrored axes fit no rotation, which would pass for noise
        noise = p["coarse_min_noise"] ** 2 * p["coarse_correlation_time"]
        a["mirror"] = mirror_evidence(p, a, noise, b)
    return True


@plain
def largest_sigma(covariance):
    """Largest of the three axis sigmas, rad."""
    return math.sqrt(max(covariance[0, 0], covariance[1, 1], covariance[2, 2]))


# ---------------------------------------------------------------------------------------------------------- filter


@plain
def add_thesis_noise(p, m, cov, period):
    """Noises gated by speed and yaw rate and the Wiener-process cross terms, (4.63) and (4.66)-(4.70)."""
    sigma, steps = p["filter_acceleration_noise"], period / REFERENCE_PERIOD
    speed, rate = m["speed"] ** 2 * steps, m["yaw_rate"] ** 2 * steps
    cov[SPEED, SPEED] += sigma * period**3 / 3
    cov[SPEED, ACCELERATION] += sigma * period**2 / 2
    cov[ACCELERATION, SPEED] += sigma * period**2 / 2
    cov[ACCELERATION, ACCELERATION] += sigma * period
    cov[YAW_RATE, YAW_RATE] += p["filter_yaw_rate_noise_per_speed"] * speed
    for i in range(3):
        cov[ATTITUDE + i, ATTITUDE + i] += p["filter_attitude_noise_per_yaw_rate"] * rate
        cov[MOUNTING + i, MOUNTING + i] += p["filter_mounting_noise_per_yaw_rate"] * rate


@plain
def add_motion_noise(p, cov, period):
    """Acceleration and yaw rate take new values, which hold over the epoch, so that they are its means."""
    cov[ACCELERATION, ACCELERATION] += p["filter_acceleration_noise"] * period
    cov[YAW_RATE, YAW_RATE] += p["filter_yaw_rate_noise"] * period


@plain
def add_slow_noise(p, m, cov, period, distance):
    """What drifts with time, and the road, which changes with the distance driven."""
    cov[ATTITUDE + 2, ATTITUDE + 2] += p["filter_heading_noise"] * period
    cov[ALTITUDE, ALTITUDE] += p["filter_altitude_drift"] * period
    cov[LATENCY, LATENCY] += p["filter_latency_noise"] * period
    mounting = p["filter_mounting_noise"]
    if math.isfinite(p["filter_noise_memory"]) and not trusted(p, m):
        mounting = p["filter_doubt_noise"]
    for i in range(3):
        cov[MOUNTING + i, MOUNTING + i] += mounting * period
        cov[BIAS + i, BIAS + i] += p["filter_bias_noise"] * period
        cov[GYRO_BIAS + i, GYRO_BIAS + i] += p["filter_gyro_bias_noise"] * period
    for i in range(2):  # the body sits anew on its springs
        cov[BOUNCE + i, BOUNCE + i] = p["filter_bounce_sigma"] ** 2
    for axis in range(2):
        sigma = math.sqrt(m["road_variance"][axis])
        curve = 1 / (p["filter_bank_length"] if axis == 0 else p["filter_grade_length"])
        x = curve * distance
        decay = math.exp(-2 * x)
        i, j = ATTITUDE + axis, GRADIENT + axis
        # stationary covariance minus what the transition leaves of it
        cov[i, i] += sigma**2 * (1 - decay * ((1 + x) ** 2 + x**2))
        cross = sigma**2 * decay * 2 * x**2 * curve
        cov[i, j] += cross
        cov[j, i] += cross
        cov[j, j] += (sigma * curve) ** 2 * (1 - decay * (x**2 + (1 - x) ** 2))


@plain
def set_heading(m, course):
    """Level attitude with the heading of a course (clockwise from north)."""
    half = 0.5 * (0.5 * math.pi - course)
    m["q_nv"][0] = math.cos(half)
    m["q_nv"][1] = 0.0
    m["q_nv"][2] = 0.0
    m["q_nv"][3] = math.sin(half)


@plain
def turn_rows(rows, t):
    """Turn three rows by a rotation."""
    for j in range(rows.shape[1]):
        x, y, z = rows[0, j], rows[1, j], rows[2, j]
        for i in range(3):
            rows[i, j] = t[i, 0] * x + t[i, 1] * y + t[i, 2] * z


@plain
def mirror_rows(cov, n, first, last):
    """Let columns [first, last) of a symmetric matrix be what its rows are; among these, what is left of the diagonal.

    Every row that was changed is mirrored, the last one first: then what is left of the diagonal holds among them all.
    """
    for i in range(first, last):
        for j in range(i):
            cov[j, i] = cov[i, j]
        for j in range(last, n):
            cov[j, i] = cov[i, j]


@plain
def keep_level_covariance(m, before, n, w):
    """After a change of the attitude: its covariance stays what it is in the level frame."""
    after, t = w["r_turned"], w["turn"]
    rotation_matrix(m["q_nv"], after)
    for i in range(3):
        for j in range(3):
            t[i, j] = 0.0
            for k in range(3):
                t[i, j] += after[k, i] * before[k, j]
    cov = m["covariance"]
    turn_rows(cov[ATTITUDE : ATTITUDE + 3, :n], t)
    turn_rows(cov[ATTITUDE : ATTITUDE + 3, ATTITUDE : ATTITUDE + 3].T, t)
    mirror_rows(cov, n, ATTITUDE, ATTITUDE + 3)


@plain
def clear_state(cov, first, last):
    """Take the uncertainty of the states [first, last) and their correlation with all others out."""
    for i in range(first, last):
        for j in range(cov.shape[0]):
            cov[i, j] = 0.0
            cov[j, i] = 0.0


@plain
def begin_motion(p, m, e):
    """Forget the motion and the attitude of the vehicle, keep mounting and biases: start, outage, reversing."""
    speed = e["speed"]
    m["speed"] = speed
    m["acceleration"] = 0.0
    m["yaw_rate"] = 0.0
    m["gradient"][:] = 0.0
    m["bounce"][:] = 0.0
    m["bounce_before"][:] = 0.0
    m["yaw_rate_before"] = m["last_forward"] = m["last_lateral"] = 0.0
    set_heading(m, e["course"])
    cov = m["covariance"]
    clear_state(cov, 0, MOUNTING)
    clear_state(cov, BOUNCE, STATES)
    for i in range(2):
        cov[BOUNCE + i, BOUNCE + i] = p["filter_bounce_sigma"] ** 2
    noise = e["speed_noise"]
    cov[SPEED, SPEED] = (2 * noise) ** 2
    cov[ACCELERATION, ACCELERATION] = 1.0
    cov[YAW_RATE, YAW_RATE] = 0.1**2
    cov[ATTITUDE, ATTITUDE] = m["road_variance"][0]
    cov[ATTITUDE + 1, ATTITUDE + 1] = m["road_variance"][1]
    cov[ATTITUDE + 2, ATTITUDE + 2] = (2 * noise / max(speed, 0.5)) ** 2
    cov[GRADIENT, GRADIENT] = m["road_variance"][0] / p["filter_bank_length"] ** 2
    cov[GRADIENT + 1, GRADIENT + 1] = m["road_variance"][1] / p["filter_grade_length"] ** 2
    begin_altitude(m, np.nan, 0.0)
    m["aligned"] = True


@plain
def begin_altitude(m, altitude, sigma):
    """Take the altitude as it is given: only its changes count."""
    m["altitude"] = altitude
    clear_state(m["covariance"], ALTITUDE, ALTITUDE + 1)
    m["covariance"][ALTITUDE, ALTITUDE] = sigma**2


@making
def start_filter(p, m, e, q, covariance, bias, latency):
    """Start the filter at a mounting with its covariance, everything else at its prior."""
    cov = m["covariance"]
    cov[:] = 0.0
    m["q_vs"][:] = q
    m["bias"][:] = bias
    m["gyro_bias"][:] = 0.0
    m["lever_arm"][0] = p["filter_lever_arm"]
    m["lever_arm"][1] = 0.0
    m["antenna"] = 0.0
    m["latency"] = latency
    m["noise_factor"][:] = p["filter_start_noise_factor"]
    m["suspension"][0] = p["filter_pitch_per_acceleration"]
    m["suspension"][1] = p["filter_roll_per_acceleration"]
    m["road_variance"][0] = p["filter_bank_sigma"] ** 2
    m["road_variance"][1] = p["filter_grade_sigma"] ** 2
    begin_motion(p, m, e)
    for i in range(3):
        for j in range(3):
            cov[MOUNTING + i, MOUNTING + j] = p["filter_start_inflation"] ** 2 * covariance[i, j]
        cov[BIAS + i, BIAS + i] = p["filter_bias_sigma"] ** 2
        cov[GYRO_BIAS + i, GYRO_BIAS + i] = p["filter_gyro_bias_sigma"] ** 2
    for i in range(2):
        cov[LEVER_ARM + i, LEVER_ARM + i] = p["filter_lever_arm_sigma"] ** 2
        cov[SUSPENSION + i, SUSPENSION + i] = p["filter_suspension_sigma"] ** 2
    cov[ANTENNA, ANTENNA] = p["filter_antenna_sigma"] ** 2
    cov[LATENCY, LATENCY] = p["filter_latency_sigma"] ** 2
    m["running"] = True


@making
def mounting_covariance(m):
    """Covariance of the filter's mounting, (3, 3)."""
    return m["covariance"][MOUNTING : MOUNTING + 3, MOUNTING : MOUNTING + 3].copy()


@making
def refine(p, m, a, e):
    """Start once more when the mounting is known well enough.

    What was learnt about lever arm, suspension and biases while it was far off rests on wrong axes.
    """
    if m["refined"] or not math.isfinite(e["course"]):
        return
    covariance = mounting_covariance(m)
    if largest_sigma(covariance) > p["filter_refine_sigma"]:
        return
    start_filter(p, m, e, m["q_vs"].copy(), covariance, a["bias"], m["latency"])
    m["refined"] = True


@plain
def start_at_identity(p, m):
    """Start as in thesis 5.2: x = 0, P = Q, both quaternions 1 in the frames of the thesis.

    Heading north, and sensor axes along forward, right, down. The heading follows from the first course in motion.
    """
    m["covariance"][:] = 0.0
    m["speed"] = 1.0
    m["yaw_rate"] = 1.0
    add_thesis_noise(p, m, m["covariance"], REFERENCE_PERIOD)
    m["speed"] = 0.0
    m["acceleration"] = 0.0
    m["yaw_rate"] = 0.0
    set_heading(m, 0.0)
    m["q_vs"][:] = 0.0
    m["q_vs"][1] = 1.0
    m["running"] = True
    m["aligned"] = False


@plain
def road_transition(length, distance, f):
    """Transition of an angle of the road and its gradient, critically damped over the distance."""
    x = distance / length
    decay = math.exp(-x)
    f[0, 0] = decay * (1 + x)
    f[0, 1] = decay * distance
    f[1, 0] = -decay * x / length
    f[1, 1] = decay * (1 - x)


@plain
def predict_state(p, m, period, distance, r, bank, grade):
    """Prediction (4.37)-(4.51): speed, turn about the vertical, road under the vehicle, altitude.

    `r` is the rotation of the attitude before it.
    """
    m["last_forward"] = m["acceleration"]
    m["last_lateral"] = m["speed"] * m["yaw_rate"]
    road_transition(p["filter_bank_length"], distance, bank)
    road_transition(p["filter_grade_length"], distance, grade)
    roll, pitch = math.asin(r[2, 1]), -math.asin(r[2, 0])
    roll_step = (bank[0, 0] - 1) * roll + bank[0, 1] * m["gradient"][0]
    pitch_step = (grade[0, 0] - 1) * pitch + grade[0, 1] * m["gradient"][1]
    m["gradient"][0] = bank[1, 0] * roll + bank[1, 1] * m["gradient"][0]
    m["gradient"][1] = grade[1, 0] * pitch + grade[1, 1] * m["gradient"][1]
    m["speed"] += period * m["acceleration"]
    turn(m["q_nv"], 0.0, 0.0, period * m["yaw_rate"])
    m["yaw_rate_before"] = m["yaw_rate"]
    turn_right(m["q_nv"], roll_step, pitch_step, 0.0)
    m["altitude"] += distance * r[2, 0]
    for i in range(2):
        m["bounce_before"][i], m["bounce"][i] = m["bounce"][i], 0.0


@plain
def transition_rows(cov, first, last, period, share, distance, up, bank, grade):
    """F P in columns [first, last), for the transition F; `up` is the vertical in vehicle axes."""
    for j in range(first, last):
        cov[ALTITUDE, j] += period * up[0] * cov[SPEED, j] + distance * (
            up[1] * cov[ATTITUDE + 2, j] - up[2] * cov[ATTITUDE + 1, j]
        )
        cov[SPEED, j] += period * cov[ACCELERATION, j]
        turned = period * ((1 - share) * cov[YAW_RATE, j] + share * cov[YAW_RATE_BEFORE, j])
        x, y = cov[ATTITUDE, j], cov[ATTITUDE + 1, j]
        cx, cy = cov[GRADIENT, j], cov[GRADIENT + 1, j]
        cov[ATTITUDE, j] = bank[0, 0] * x + bank[0, 1] * cx + up[0] * turned
        cov[GRADIENT, j] = bank[1, 0] * x + bank[1, 1] * cx
        cov[ATTITUDE + 1, j] = grade[0, 0] * y + grade[0, 1] * cy + up[1] * turned
        cov[GRADIENT + 1, j] = grade[1, 0] * y + grade[1, 1] * cy
        cov[ATTITUDE + 2, j] += up[2] * turned


@plain
def remember_rows(cov, n):
    """Keep what was at the end of the last epoch as what is at the beginning of this one."""
    for j in range(STATES):
        cov[YAW_RATE_BEFORE, j] = cov[YAW_RATE, j]
    if n == STATES:
        for i in range(2):
            for j in range(STATES):
                cov[BOUNCE_BEFORE + i, j], cov[BOUNCE + i, j] = cov[BOUNCE + i, j], 0.0


@plain
def predict(p, m, period, n, w):
    """Prediction of state and covariance over one epoch; the turn is folded into the reference attitude at once."""
    cov = m["covariance"]
    bank, grade, up, r = w["bank"], w["grade"], w["up"], w["r_nv"]
    distance = period * m["speed"]
    rotation_matrix(m["q_nv"], r)
    up[0], up[1], up[2] = r[2, 0], r[2, 1], r[2, 2]
    remember_rows(cov, n)
    remember_rows(cov.T, n)
    if p["filter_constant_over_epoch"]:
        add_motion_noise(p, cov, period)
    predict_state(p, m, period, distance, r, bank, grade)
    share = p["filter_mean_share"]
    transition_rows(cov, 0, n, period, share, distance, up, bank, grade)
    for first, last in MOVED:  # the columns where rows and columns have moved; elsewhere they are as the rows
        transition_rows(cov.T, first, last, period, share, distance, up, bank, grade)
    for first, last in MOVED:
        mirror_rows(cov, n, first, last)
    if not p["filter_constant_over_epoch"]:
        add_thesis_noise(p, m, cov, period)
    add_slow_noise(p, m, cov, period, distance)


@plain
def predict_force(m, period, share, exact, up, force, jacobian, partials):
    """Specific force in vehicle axes and its Jacobian.

    Kinematic acceleration of the device by Rivals' formula (seed 004 eq. 4), gravity on the road's slope, and the body
    leaning on its springs. `share` is the part of the epoch between its middle, which the means stand for, and its end.
    """
    arm, gained = m["lever_arm"], m["yaw_rate"] - m["yaw_rate_before"]
    rate, spin = m["yaw_rate"] - share * gained, gained / period
    speed = m["speed"] - share * period * m["acceleration"]
    curve = m["gradient"][1] if exact else 0.0
    left_y, left_z = (up[2], -up[1]) if exact else (1.0, 0.0)  # the vehicle turns about the vertical
    forward = m["acceleration"] - rate * rate * arm[0] - spin * arm[1]
    lateral = speed * rate + spin * arm[0] - rate * rate * arm[1]
    dive, lean = m["suspension"][0], m["suspension"][1]
    road = forward + GRAVITY * up[0]
    side = lateral * left_y + GRAVITY * up[1]
    stiff = GRAVITY * up[2] + lateral * left_z - speed * speed * curve
    rolled = 0.5 * (m["bounce"][0] + m["bounce_before"][0])
    pitched = 0.5 * (m["bounce"][1] + m["bounce_before"][1])
    force[0] = road + stiff * dive * forward - GRAVITY * pitched
    force[1] = side + stiff * lean * lateral + GRAVITY * rolled
    force[2] = stiff - dive * forward * road - lean * lateral * side
    partials[:] = 0.0
    d_forward, d_lateral = partials[0], partials[1]
    d_road, d_side, d_stiff = partials[2], partials[3], partials[4]
    d_forward[ACCELERATION] = 1.0
    d_forward[YAW_RATE] = -2 * (1 - share) * rate * arm[0] - arm[1] / period
    d_forward[YAW_RATE_BEFORE] = -2 * share * rate * arm[0] + arm[1] / period
    d_forward[LEVER_ARM] = -rate * rate
    d_forward[LEVER_ARM + 1] = -spin
    d_lateral[SPEED] = rate
    d_lateral[ACCELERATION] = -share * period * rate
    d_lateral[YAW_RATE] = (1 - share) * (speed - 2 * rate * arm[1]) + arm[0] / period
    d_lateral[YAW_RATE_BEFORE] = share * (speed - 2 * rate * arm[1]) - arm[0] / period
    d_lateral[LEVER_ARM] = spin
    d_lateral[LEVER_ARM + 1] = -rate * rate
    d_stiff[SPEED] = -2 * speed * curve
    d_stiff[ACCELERATION] = 2 * speed * curve * share * period
    d_stiff[GRADIENT + 1] = -speed * speed if exact else 0.0
    for i in range(3):  # d up = [up x] alpha
        x, y, z = cross_column(up, i)
        d_road[ATTITUDE + i] = GRAVITY * x
        d_side[ATTITUDE + i] = GRAVITY * y + (lateral * z if exact else 0.0)
        d_stiff[ATTITUDE + i] = GRAVITY * z - (lateral * y if exact else 0.0)
    jacobian[0, BOUNCE + 1] = jacobian[0, BOUNCE_BEFORE + 1] = -0.5 * GRAVITY
    jacobian[1, BOUNCE] = jacobian[1, BOUNCE_BEFORE] = 0.5 * GRAVITY
    for j in range(GYRO_BIAS):
        d_road[j] += d_forward[j]
        d_side[j] += left_y * d_lateral[j]
        d_stiff[j] += left_z * d_lateral[j]
        jacobian[0, j] = d_road[j] + dive * (stiff * d_forward[j] + forward * d_stiff[j])
        jacobian[1, j] = d_side[j] + lean * (stiff * d_lateral[j] + lateral * d_stiff[j])
        jacobian[2, j] = (
            d_stiff[j]
            - dive * (forward * d_road[j] + road * d_forward[j])
            - lean * (lateral * d_side[j] + side * d_lateral[j])
        )
    jacobian[0, SUSPENSION] = stiff * forward
    jacobian[1, SUSPENSION + 1] = stiff * lateral
    jacobian[2, SUSPENSION] = -forward * road
    jacobian[2, SUSPENSION + 1] = -lateral * side


@plain
def cross_column(u, i):
    """Column i of [u x]."""
    if i == 0:
        return 0.0, u[2], -u[1]
    if i == 1:
        return -u[2], 0.0, u[0]
    return u[1], -u[0], 0.0


@plain
def predict_rate(m, period, share, up, rate, jacobian):
    """Angular rate in vehicle axes and its Jacobian: the vehicle turns, the road tilts it, it leans on its springs."""
    speed, turning = m["speed"], m["yaw_rate"] - share * (m["yaw_rate"] - m["yaw_rate_before"])
    dive, lean = m["suspension"][0] / period, m["suspension"][1] / period
    surge = m["acceleration"] - m["last_forward"]
    sway = speed * turning - m["last_lateral"]
    rate[0] = turning * up[0] + speed * m["gradient"][0] + lean * sway
    rate[1] = turning * up[1] + speed * m["gradient"][1] - dive * surge
    rate[2] = turning * up[2]
    for i in range(2):
        rate[i] += (m["bounce"][i] - m["bounce_before"][i]) / period
        jacobian[i, BOUNCE + i] = 1.0 / period
        jacobian[i, BOUNCE_BEFORE + i] = -1.0 / period
    jacobian[0, SPEED] = m["gradient"][0] + lean * turning
    jacobian[1, SPEED] = m["gradient"][1]
    jacobian[1, ACCELERATION] = -dive
    for column, part in ((YAW_RATE, 1 - share), (YAW_RATE_BEFORE, share)):
        jacobian[0, column] = part * (up[0] + lean * speed)
        jacobian[1, column] = part * up[1]
        jacobian[2, column] = part * up[2]
    jacobian[0, GRADIENT] = speed
    jacobian[1, GRADIENT + 1] = speed
    jacobian[0, SUSPENSION + 1] = sway / period
    jacobian[1, SUSPENSION] = -surge / period
    for i in range(3):
        x, y, z = cross_column(up, i)
        jacobian[0, ATTITUDE + i] = turning * x
        jacobian[1, ATTITUDE + i] = turning * y
        jacobian[2, ATTITUDE + i] = turning * z


@plain
def add_mounting(vector, h):
    """Columns of the mounting for a vector read in sensor axes and turned into the vehicle's: [vector x]."""
    h[0, MOUNTING + 1] = -vector[2]
    h[0, MOUNTING + 2] = vector[1]
    h[1, MOUNTING] = vector[2]
    h[1, MOUNTING + 2] = -vector[0]
    h[2, MOUNTING] = -vector[1]
    h[2, MOUNTING + 1] = vector[0]


@plain
def turned(r, vector, i):
    """Component i of R times a vector."""
    return r[i, 0] * vector[0] + r[i, 1] * vector[1] + r[i, 2] * vector[2]


@plain
def predict_velocity(m, r_nv, z, h):
    """Velocity of the antenna (4.59): the vehicle's, and what its turning adds sideways."""
    speed, rate = m["speed"], m["yaw_rate"]
    ahead = m["lever_arm"][0] + m["antenna"]
    side = rate * ahead
    for i in range(3):
        x, y, w = r_nv[i, 0], r_nv[i, 1], r_nv[i, 2]
        z[i] = x * speed + y * side
        h[i, SPEED] = x
        h[i, YAW_RATE] = y * ahead
        h[i, LEVER_ARM] = y * rate
        h[i, ANTENNA] = y * rate
        h[i, ATTITUDE] = w * side
        h[i, ATTITUDE + 1] = -w * speed
        h[i, ATTITUDE + 2] = y * speed - x * side


@plain
def predict_measurements(p, m, e, r_vs, z, h, w):
    """Z = h(x) and its Jacobian: specific force (4.55), velocity (4.59), yaw rate (4.60), angular rate, height.

    What the sensor reads is turned into the axes of the vehicle, as far as they are known, and predicted there: what
    the update does to a component (gate, learnt noise) then turns with the log.
    """
    r_nv = w["r_nv"]
    rotation_matrix(m["q_nv"], r_nv)
    up, share, exact = r_nv[2], p["filter_mean_share"], p["filter_exact_kinematics"]
    h[:] = 0.0
    predict_force(m, e["period"], share, exact, up, z[FORCE:], h[FORCE:], w["partials"])
    add_mounting(z[FORCE:], h[FORCE:])
    if z[FORCE] * z[FORCE] + z[FORCE + 1] * z[FORCE + 1] < p["filter_least_acceleration"] ** 2:
        h[FORCE, MOUNTING + 2] = h[FORCE + 1, MOUNTING + 2] = 0.0
    predict_velocity(m, r_nv, z[VELOCITY:], h[VELOCITY:])
    if e["gyro"]:
        predict_rate(m, e["period"], share, up, z[RATE:], h[RATE:])
        add_mounting(z[RATE:], h[RATE:])
    for i in range(3):
        z[FORCE + i] += turned(r_vs, m["bias"], i)
        h[FORCE + i, LATENCY] = turned(r_vs, e["f_slope"], i)
        for j in range(3):
            h[FORCE + i, BIAS + j] = r_vs[i, j]
        if e["gyro"]:
            z[RATE + i] += turned(r_vs, m["gyro_bias"], i)
            h[RATE + i, LATENCY] = turned(r_vs, e["w_slope"], i)
            for j in range(3):
                h[RATE + i, GYRO_BIAS + j] = r_vs[i, j]
    for row in (COURSE_RATE, STANDSTILL):
        z[row] = m["yaw_rate"]
        h[row, YAW_RATE] = 1.0
    z[HEIGHT] = m["altitude"]
    h[HEIGHT, ALTITUDE] = 1.0


@plain
def observe(p, m, e, r_vs, y, noise):
    """Fill the measurements y and their standard deviations; infinite = not measured in this epoch."""
    noise[:] = np.inf
    y[:] = 0.0
    for i in range(3):
        y[FORCE + i] = turned(r_vs, e["f_s"], i)
        noise[FORCE + i] = p["filter_accelerometer_noise"] * learnt_noise(p, m, FORCES)
    if math.isfinite(e["course"]):
        y[VELOCITY] = e["speed"] * math.sin(e["course"])
        y[VELOCITY + 1] = e["speed"] * math.cos(e["course"])
        noise[VELOCITY] = noise[VELOCITY + 1] = e["speed_noise"] * learnt_noise(p, m, VELOCITIES)
    if math.isfinite(e["vertical_speed"]):
        y[VELOCITY + 2] = e["vertical_speed"]
        noise[VELOCITY + 2] = p["filter_vertical_speed_noise"]
    elif math.isfinite(e["climb"]):
        y[VELOCITY + 2] = e["climb"]
        noise[VELOCITY + 2] = p["filter_climb_noise"]
    if math.isfinite(e["yaw_rate"]):
        y[COURSE_RATE] = e["yaw_rate"]
        noise[COURSE_RATE] = p["filter_course_rate_noise"]
    if e["gyro"]:
        for i in range(3):
            y[RATE + i] = turned(r_vs, e["w_s"], i)
            noise[RATE + i] = p["filter_gyro_noise"]
    if e["mean_speed"] < 0.3 * p["epoch_moving_speed"]:
        noise[STANDSTILL] = p["filter_standstill_yaw_rate_noise"]
    if math.isfinite(e["altitude"]) and math.isfinite(m["altitude"]):
        y[HEIGHT] = e["altitude"]
        noise[HEIGHT] = p["filter_altitude_noise"] * learnt_noise(p, m, HEIGHTS)


@plain
def times_columns(cov, row, n, ph):
    """P times a row of the Jacobian; two columns at once, since to go through `ph` takes longer than to add."""
    for i in range(n):
        ph[i] = 0.0
    other = -1
    for j in range(n):
        if row[j] == 0.0:
            continue
        if other < 0:
            other = j
            continue
        one, two = row[other], row[j]
        for i in range(n):
            ph[i] += one * cov[other, i] + two * cov[j, i]
        other = -1
    if other >= 0:
        one = row[other]
        for i in range(n):
            ph[i] += one * cov[other, i]


@plain
def update(p, m, e, n, w):
    """Update (4.18)-(4.23): scalar after scalar about one point of linearisation, the same as all at once."""
    cov = m["covariance"]
    z, y, noise, h, dx, ph, r_vs = w["z"], w["y"], w["noise"], w["h"], w["dx"], w["ph"], w["r_vs"]
    dx[:] = 0.0
    rotation_matrix(m["q_vs"], r_vs)
    predict_measurements(p, m, e, r_vs, z, h, w)
    observe(p, m, e, r_vs, y, noise)
    if not math.isfinite(noise[VELOCITY]):  # no course: the speed alone, along the vehicle
        h[VELOCITY, :] = 0.0
        h[VELOCITY, SPEED] = 1.0
        y[VELOCITY], z[VELOCITY], noise[VELOCITY] = e["speed"], m["speed"], e["speed_noise"]
    for row in range(MEASUREMENTS):
        if not math.isfinite(noise[row]):
            continue
        times_columns(cov, h[row], n, ph)
        innovation, variance = y[row] - z[row], 0.0
        for j in range(n):
            if h[row, j] != 0.0:
                innovation -= h[row, j] * dx[j]
                variance += h[row, j] * ph[j]
        total = variance + noise[row] ** 2
        if innovation * innovation > p["filter_gate"] ** 2 * total:
            total = innovation * innovation / p["filter_gate"] ** 2
        if VELOCITY <= row < VELOCITY + 2:
            learn_noise(p, m, VELOCITIES, (innovation * innovation - variance) / e["speed_noise"] ** 2)
        elif row == HEIGHT:
            learn_noise(p, m, HEIGHTS, (innovation * innovation - variance) / p["filter_altitude_noise"] ** 2)
        elif row == FORCE + 2:  # upright: driving hides the noise of the others
            learn_noise(p, m, FORCES, (innovation * innovation - variance) / p["filter_accelerometer_noise"] ** 2)
        scale = 1.0 / math.sqrt(total)
        for i in range(n):
            ph[i] *= scale
            dx[i] += ph[i] * innovation * scale
        for i in range(n):
            part = ph[i]
            for j in range(n):
                cov[i, j] -= part * ph[j]  # a square, which keeps the matrix exactly symmetric
    fold(p, m, dx, n, w)
    if not math.isfinite(m["altitude"]) and math.isfinite(e["altitude"]) and math.isfinite(p["filter_altitude_noise"]):
        begin_altitude(m, e["altitude"], p["filter_altitude_noise"])


@plain
def learn_noise(p, m, which, ratio):
    """Variance of a kind of measurement relative to the usual: receivers smooth, and phones err more than they say.

    Mean square of the innovations less what the filter did not know (covariance matching).
    """
    if not math.isfinite(p["filter_noise_memory"]):
        return
    factor = m["noise_factor"]
    ratio = min(max(ratio, -p["filter_max_noise_factor"]), p["filter_max_noise_factor"] ** 2)
    factor[which] += (ratio - factor[which]) / p["filter_noise_memory"]
    if which == VELOCITIES:  # reflections off houses come in bursts
        factor[LATELY] += (ratio - factor[LATELY]) / p["filter_burst_memory"]


@plain
def trusted(p, m):
    """The receiver does not err much more than usual just now, as it does between houses."""
    return m["noise_factor"][LATELY] < p["settling_doubt"] * max(m["noise_factor"][VELOCITIES], 1.0)


@plain
def learnt_noise(p, m, which):
    """Factor of the standard deviation: never less than the usual."""
    factor = max(m["noise_factor"][which], 1.0)
    if which == VELOCITIES and not trusted(p, m):
        factor = max(factor, m["noise_factor"][LATELY])
    return math.sqrt(min(factor, p["filter_max_noise_factor"] ** 2))


@plain
def learn_road(p, m, distance, w):
    """Variance of the road's bank and grade: the mean square of their estimates and uncertainties (EM)."""
    share = min(distance / p["filter_road_memory"], 1.0)
    r = w["r_nv"]
    rotation_matrix(m["q_nv"], r)
    for axis in range(2):
        angle = r[2, 1] if axis == 0 else r[2, 0]
        square = angle * angle + m["covariance"][ATTITUDE + axis, ATTITUDE + axis]
        variance = m["road_variance"][axis] + share * (square - m["road_variance"][axis])
        m["road_variance"][axis] = min(max(variance, p["filter_min_road_sigma"] ** 2), p["filter_max_road_sigma"] ** 2)


@plain
def fold(p, m, dx, n, w):
    """Fold the error state into the references and reset it (4.29), (4.30); the speed stays positive."""
    m["speed"] = max(m["speed"] + dx[SPEED], 0.0)
    m["acceleration"] += dx[ACCELERATION]
    m["yaw_rate"] += dx[YAW_RATE]
    m["yaw_rate_before"] += dx[YAW_RATE_BEFORE]
    before = w["r_nv"]
    rotation_matrix(m["q_nv"], before)
    turn_right(m["q_nv"], dx[ATTITUDE], dx[ATTITUDE + 1], dx[ATTITUDE + 2])
    if p["filter_level_errors"]:
        keep_level_covariance(m, before, n, w)
    turn(m["q_vs"], dx[MOUNTING], dx[MOUNTING + 1], dx[MOUNTING + 2])
    for i in range(3):
        m["bias"][i] += dx[BIAS + i]
        m["gyro_bias"][i] += dx[GYRO_BIAS + i]
    for i in range(2):
        m["gradient"][i] += dx[GRADIENT + i]
        m["bounce"][i] += dx[BOUNCE + i]
        m["bounce_before"][i] += dx[BOUNCE_BEFORE + i]
        m["lever_arm"][i] += dx[LEVER_ARM + i]
        m["suspension"][i] += dx[SUSPENSION + i]
    m["antenna"] += dx[ANTENNA]
    m["altitude"] += dx[ALTITUDE]
    longest = (p["epoch_latency_count"] - 1) * p["epoch_latency_step"]
    m["latency"] = min(max(m["latency"] + dx[LATENCY], 0.0), longest)


@plain
def start_where_possible(p, m, a, e, w):
    """Start the filter or its motion where it is not running; True when there is a step to make already."""
    heading_known = e["moving"] and math.isfinite(e["course"])
    if not p["filter_start_from_coarse"]:
        if not m["running"]:
            start_at_identity(p, m)
        if not m["aligned"] and heading_known:
            before = w["r_nv"]
            rotation_matrix(m["q_nv"], before)
            set_heading(m, e["course"])
            keep_level_covariance(m, before, STATES, w)
            m["aligned"] = True
        return True
    if m["running"] and m["aligned"]:
        return True
    if not heading_known:
        return False
    if m["running"]:
        begin_motion(p, m, e)
        return False
    sigma = largest_sigma(a["covariance"])
    if not math.isfinite(a["solved_time"]) or sigma > p["filter_start_sigma"]:
        return False
    start_filter(p, m, e, a["q_vs"], a["covariance"], a["bias"], a["latency"])
    m["refined"] = sigma < p["filter_refine_sigma"]
    return False


@plain
def step_filter(p, c, m, a, e, w):
    """One epoch: start where it can be started, else predict and update; True when the filter made a step."""
    if not e["usable"]:
        m["aligned"] = False
        return False
    if not start_where_possible(p, m, a, e, w):
        return False
    if not delayed_signals(p, c, m["latency"], e, w):
        m["aligned"] = False
        return False
    m["gyro"] = m["gyro"] or e["gyro"]
    n = STATES if m["gyro"] else GYRO_BIAS  # without a gyroscope the last states are not carried
    predict(p, m, e["period"], n, w)
    update(p, m, e, n, w)
    if math.isfinite(p["filter_road_memory"]):
        learn_road(p, m, e["period"] * e["mean_speed"], w)
    if p["filter_start_from_coarse"]:
        refine(p, m, a, e)
    return True


# ----------------------------------------------------------------------------------- settling, verification, change


@plain
def noise_ratio(p, a):
    """How much more than usual the coarse alignment's residual is, at least 1: poor receivers, phones, loose roads.

    It multiplies every stated sigma: what disturbs the one disturbs the other.
    """
    return max(a["noise_density"] / (p["coarse_min_noise"] ** 2 * p["coarse_correlation_time"]), 1.0)


@plain
def mounting_sigma(p, covariance, offset, ratio, sigma):
    """1 sigma about the vehicle axes, with what the model leaves out added in square."""
    for i in range(3):
        sigma[i] = math.sqrt(ratio**2 * covariance[offset + i, offset + i] + p["settling_systematic_sigma"] ** 2)
        sigma[i] = min(sigma[i], math.pi)


@plain
def move_average(p, s, q, period, w):
    """Moving average (5.4) over the last n epochs, signs aligned; gives how fast it turns, rad/s."""
    size = s["ring"].shape[0]
    head = (s["head"] + 1) % size
    sign = 1.0
    if s["count"] > 0:
        dot = 0.0
        for i in range(4):
            dot += q[i] * s["ring"][s["head"], i]
        sign = -1.0 if dot < 0 else 1.0
    for i in range(4):
        s["ring"][head, i] = sign * q[i]
    s["head"] = head
    wanted = size
    if math.isfinite(p["settling_average_window"]):
        wanted = min(max(int(p["settling_average_window"] / period), 5), size)
    s["count"] = min(s["count"] + 1, size)
    used = min(s["count"], wanted)
    mean, step = w["mean"], w["d"]
    mean[:] = 0.0
    for back in range(used):
        for i in range(4):
            mean[i] += s["ring"][(head - back) % size, i]
    norm = math.sqrt(mean[0] ** 2 + mean[1] ** 2 + mean[2] ** 2 + mean[3] ** 2)
    sign = -1.0 if mean[0] < 0 else 1.0
    for i in range(4):
        mean[i] *= sign / norm
    difference(mean, s["average"], step)
    for i in range(4):
        s["average"][i] = mean[i]
    if used < wanted:
        return np.inf
    return math.sqrt(step[0] ** 2 + step[1] ** 2 + step[2] ** 2) / period


@plain
def second_opinion(p, m, a, w):
    """Filter and coarse alignment agree, within their sigmas and within an angle."""
    if not math.isfinite(a["solved_time"]):
        return False
    d, total = w["d"], w["total"]
    difference(m["q_vs"], a["q_vs"], d)
    for i in range(3):
        for j in range(3):
            total[i, j] = m["covariance"][MOUNTING + i, MOUNTING + j] + a["covariance"][i, j]
        total[i, i] += 2 * p["settling_systematic_sigma"] ** 2 + 1e-12
    near = d[0] ** 2 + d[1] ** 2 + d[2] ** 2 < p["settling_second_opinion_angle"] ** 2
    return near and mahalanobis(d, total) < 3 * p["settling_second_opinion_sigmas"] ** 2


@plain
def settle(p, s, m, a, e, sigma, w):
    """STABLE and RELIABLE."""
    s["stable"] = move_average(p, s, m["q_vs"], e["period"], w) < p["settling_stable_rate"]
    if p["settling_reliable_yaw_rate"] > 0:
        turning = e["moving"] and abs(e["yaw_rate"]) > p["settling_reliable_yaw_rate"]
        s["reliable"] = s["reliable"] or turning
        s["agrees"] = True
        return
    s["right_handed"] = a["mirror"] < (p["fault_mirror_doubt"] if s["right_handed"] else p["fault_right_handed"])
    s["agrees"] = second_opinion(p, m, a, w)
    informed = max(sigma[0], sigma[1]) < p["settling_start_tilt_sigma"] and sigma[2] < p["settling_start_yaw_sigma"]
    excited = s["forward_excitation"] + s["lateral_excitation"] > p["settling_excitation"]
    s["reliable"] = informed and excited and s["agrees"] and s["right_handed"] and trusted(p, m)


@plain
def soft_start(s):
    """Soft initialisation (thesis 6.2): the booleans are reset, the filter goes on."""
    s["stable"] = False
    s["reliable"] = False
    s["count"] = 0


@making
def start_verification(v, s, m, sigma):
    """Save the candidate and start the drive test."""
    v["state"] = 1
    v["q_vs"][:] = s["average"]
    v["bias"][:] = m["bias"]
    v["sigma"][:] = sigma
    v["elapsed"] = 0.0
    v["distance"] = 0.0
    v["excess"] = 0.0
    v["impulse"][:] = 0.0
    v["energy"] = 0.0
    v["height"] = 0.0
    v["turning"] = 0.0
    v["altitude"] = m["altitude"]
    v["error"] = 0.0
    v["limit"] = 0.0
    soft_start(s)


@making
def drive_test(p, v, m, e):
    """Integrate specific force against the GPS (5.6); True when the time is up.

    By energy: the work of the specific force is kept as a vector, so that any mounting can be tried on it at the end.
    """
    period, speed = e["period"], e["mean_speed"]
    gained = m["altitude"] - v["altitude"]
    v["altitude"] = m["altitude"]
    if not p["verification_by_energy"]:
        r = np.empty((3, 3))
        rotation_matrix(v["q_vs"], r)
        forward = 0.0
        for i in range(3):
            forward += r[0, i] * (e["f_s"][i] - v["bias"][i])
        v["excess"] += forward * period - e["speed_change"]
        v["elapsed"] += period
        v["error"] = abs(v["excess"])
        v["limit"] = p["verification_limit"]
        return v["elapsed"] >= p["verification_duration"]
    if not e["moving"]:
        return False
    for i in range(3):
        v["impulse"][i] += speed * period * e["f_s"][i]
    v["energy"] += speed * e["speed_change"]
    if not math.isfinite(gained):  # no altitude: what the filter makes of the slope
        r = np.empty((3, 3))
        rotation_matrix(m["q_nv"], r)
        gained = speed * period * r[2, 0]
    v["height"] += gained
    if math.isfinite(e["yaw_rate"]):
        v["turning"] += speed * e["yaw_rate"] ** 2 * period
    v["distance"] += speed * period
    v["elapsed"] += period
    v["error"] = drive_error(v, m, v["q_vs"], v["bias"])
    v["limit"] = drive_limit(p, v, m)
    return v["elapsed"] >= p["verification_duration"]


@plain
def drive_error(v, m, q, bias):
    """Speed error after the test under a mounting."""
    return abs(drive_departure(v, m, q, bias))


@making
def drive_departure(v, m, q, bias):
    """Speed by the sensor less that by the GPS: work of the forward specific force less the energy gained.

    The suspension adds to the forward specific force in proportion to the acceleration, the lever arm in curves.
    """
    r = np.empty((3, 3))
    rotation_matrix(q, r)
    work = 0.0
    for i in range(3):
        work += r[0, i] * (v["impulse"][i] - bias[i] * v["distance"])
    gained = (1 + GRAVITY * m["suspension"][0]) * v["energy"] + GRAVITY * v["height"]
    excess = work - gained + m["lever_arm"][0] * v["turning"]
    return excess * v["elapsed"] / max(v["distance"], 1e-9)


@plain
def tell_speed(p, v, m, e, elapsed):
    """Tell the speed by the sensor: once in each second of driving tested, of which `elapsed` were before, and last."""
    begins, ends = elapsed == 0.0, v["state"] != 1
    if v["elapsed"] > elapsed and (begins or ends or math.floor(v["elapsed"]) > math.floor(elapsed)):
        by_energy = p["verification_by_energy"]
        departure = drive_departure(v, m, v["q_vs"], v["bias"]) if by_energy else v["excess"]
        e["tested_speed"] = e["speed"] + departure
        e["test_begins"] = begins


@plain
def drive_limit(p, v, m):
    """Largest speed error that passes: t the limit, in square, what the altitude may be wrong by (2 sigma) is added."""
    variance = p["filter_altitude_drift"] * v["elapsed"] + p["filter_altitude_noise"] ** 2
    height = math.sqrt(variance) * learnt_noise(p, m, HEIGHTS)
    slack = 2 * GRAVITY * height * v["elapsed"] / max(v["distance"], 1e-9)
    if not math.isfinite(m["altitude"]):
        slack = np.inf
    return math.sqrt(p["verification_limit"] ** 2 + min(slack, p["verification_limit"]) ** 2)


@making
def confirm(s, v, t):
    """Keep the verified mounting."""
    s["confirmed"] = True
    s["has_mount"] = True
    s["suspect"] = False
    s["mount_t"] = t
    s["mount_q_vs"][:] = v["q_vs"]
    s["mount_sigma"][:] = v["sigma"]
    s["mount_error"] = v["error"]
    s["mount_limit"] = v["limit"]
    s["mount_elapsed"] = v["elapsed"]


@making
def begin_window(p, g, mekf, s):
    """Let the challenger begin anew: it knows what the filter knows, but nothing of the mounting.

    It is compared with what the filter made of all the driving before, unless that has left the confirmed mounting.
    """
    m, n, d = mekf[0], mekf[1], np.empty(3)
    difference(m["q_vs"], s["mount_q_vs"], d)
    near = d[0] ** 2 + d[1] ** 2 + d[2] ** 2 < p["change_reference_angle"] ** 2
    g["reference"][:] = m["q_vs"] if near else s["mount_q_vs"]
    g["covariance"][:] = 0.0
    if near:
        g["covariance"][:] = mounting_covariance(m)
    for i in range(3):
        g["covariance"][i, i] += p["settling_systematic_sigma"] ** 2 if near else s["mount_sigma"][i] ** 2
    mekf[1] = mekf[0]
    clear_state(n["covariance"], MOUNTING, MOUNTING + 3)
    for i in range(3):
        n["covariance"][MOUNTING + i, MOUNTING + i] = p["change_sigma"] ** 2
    g["state"] = WATCHING
    g["age"] = 0.0
    g["looked"] = 0.0
    g["excitation"] = 0.0


@making
def suspect(p, g, a, n, e):
    """Let the challenger begin from where it is, knowing nothing else.

    The device may have been turned far, and the filter, whose road and biases have made up for that, is no help. The
    coarse alignment begins anew too: its residual says how noisy the data are.
    """
    clear_sums(a)
    a["noise_density"] = 0.0
    covariance = np.zeros((3, 3))
    for i in range(3):
        covariance[i, i] = p["change_sigma"] ** 2
    start_filter(p, n, e, n["q_vs"].copy(), covariance, np.zeros(3), n["latency"])
    n["refined"] = False
    g["state"] = SUSPICIOUS
    g["guilty"] = 0
    g["quiet"] = 0.0
    g["age"] = 0.0
    g["looked"] = 0.0
    g["excitation"] = 0.0


@making
def look(p, g, n, ratio):
    """Squared Mahalanobis distance of the challenger's mounting from the reference."""
    d, total = np.empty(3), np.empty((3, 3))
    difference(n["q_vs"], g["reference"], d)
    covariance = mounting_covariance(n)
    for i in range(3):
        for j in range(3):
            total[i, j] = ratio**2 * (covariance[i, j] + g["covariance"][i, j])
        total[i, i] += p["settling_systematic_sigma"] ** 2
    return mahalanobis(d, total)


@plain
def keep_evidence(g, t, distance):
    """Append a look to the series that an alert shows."""
    size = g["series"].shape[0]
    g["series_head"] = (g["series_head"] + 1) % size
    g["series_count"] = min(g["series_count"] + 1, size)
    g["series"][g["series_head"], 0] = t
    g["series"][g["series_head"], 1] = min(distance, MOST_EVIDENCE)


@making
def judge(p, g, a, n, s, e, distance):
    """Let a suspicious challenger decide, acquit, or begin anew; True when it has decided."""
    sure = n["refined"] and largest_sigma(mounting_covariance(n)) < p["change_sure_sigma"]
    sure = sure and g["excitation"] > p["change_excitation"] and math.isfinite(a["solved_time"])
    misled = not trusted(p, n) or g["quiet"] > p["change_quiet"]
    if (sure and distance < p["change_innocent"]) or g["age"] > 2 * p["change_window"]:
        g["state"] = IDLE
    elif misled and e["moving"] and math.isfinite(e["course"]):
        suspect(p, g, a, n, e)  # a receiver that errs, or a ferry, shows nothing of the mounting
    else:
        d = np.empty(3)
        difference(n["q_vs"], s["mount_q_vs"], d)
        far = d[0] ** 2 + d[1] ** 2 + d[2] ** 2 > p["change_min_angle"] ** 2
        g["guilty"] = g["guilty"] + 1 if sure and far and distance > p["change_decision"] else 0
        return g["guilty"] >= p["change_looks"]
    return False


@plain
def watch_for_change(p, c, g, mekf, a, s, e, w):
    """Sequential test of the confirmed mounting by a challenger; True when the device has moved.

    WATCHING, the challenger begins anew every window. A distance it should hardly ever show makes it begin once more at
    once: SUSPICIOUS, it rests on data from after the suspicion alone, and decides, or acquits.
    """
    m, n = mekf[0], mekf[1]
    ready = m["running"] and m["aligned"]
    if g["state"] == IDLE and ready:
        begin_window(p, g, mekf, s)
        g["ratio"] = noise_ratio(p, a)
        g["innocent_t"] = e["t"]
        return False
    if g["state"] == IDLE or not step_filter(p, c, n, a, e, w):
        return False
    if e["moving"]:
        g["age"] += e["period"]
    if g["age"] - g["looked"] < p["change_interval"]:
        return False
    g["looked"] = g["age"]
    distance = look(p, g, n, g["ratio"] if g["state"] == WATCHING else noise_ratio(p, a))
    keep_evidence(g, e["t"], distance)
    if distance < p["change_innocent"]:
        g["innocent_t"] = e["t"]
    if g["state"] == SUSPICIOUS:
        return judge(p, g, a, n, s, e, distance)
    if distance > p["change_suspicion"] and e["moving"] and math.isfinite(e["course"]):
        suspect(p, g, a, n, e)
    elif g["age"] > p["change_window"] and ready:
        begin_window(p, g, mekf, s)
    return False


@plain
def begin_again(mekf, s, v, g):
    """After an orientation change: the challenger becomes the filter, everything else starts anew."""
    mekf[0] = mekf[1]
    soft_start(s)
    s["confirmed"] = False
    s["suspect"] = True
    s["forward_excitation"] = 0.0
    s["lateral_excitation"] = 0.0
    s["progress"] = 0.0
    v["state"] = 0
    v["elapsed"] = 0.0
    v["error"] = 0.0
    g["state"] = IDLE
    g["series_count"] = 0


@plain
def write_event(events, count, t, code, reason):
    """Append a row: t, code, reason; what follows is nan: quaternion, sigma, elapsed, error, limit, turn, since."""
    row = events[count]
    row[:] = np.nan
    row[0] = t
    row[1] = code
    row[2] = reason
    return count + 1


@plain
def write_mounting(row, q, sigma):
    """Fill in the mounting an event is about."""
    for i in range(4):
        row[3 + i] = q[i]
    for i in range(3):
        row[7 + i] = sigma[i]


@plain
def write_test(events, count, t, code, v, reason):
    """Append an event of the drive test."""
    row = events[count]
    count = write_event(events, count, t, code, reason)
    write_mounting(row, v["q_vs"], v["sigma"])
    row[10] = v["elapsed"]
    row[11] = v["error"]
    row[12] = v["limit"]
    return count


@making
def write_change(p, a, events, evidence, count, t, n, s, g):
    """Append an orientation change: the new mounting, the turn from the confirmed one, since when, and the evidence."""
    row, sigma = events[count], np.empty(3)
    mounting_sigma(p, n["covariance"], MOUNTING, noise_ratio(p, a), sigma)
    write_evidence(evidence, count, g)
    count = write_event(events, count, t, CHANGED, REASON_NONE)
    write_mounting(row, n["q_vs"], sigma)
    difference(n["q_vs"], s["mount_q_vs"], row[13:16])
    row[16] = g["innocent_t"]
    return count


@making
def write_evidence(evidence, count, g):
    """Copy the series, oldest look first, the rest nan."""
    size = g["series"].shape[0]
    evidence[count, :, :] = np.nan
    for i in range(g["series_count"]):
        back = g["series_count"] - 1 - i
        evidence[count, i, :] = g["series"][(g["series_head"] - back) % size, :]


@plain
def excite(p, s, g, e, k):
    """Sum the squared horizontal acceleration that stands out from the noise of the fixes."""
    noise = 9 * (p["filter_speed_noise"] / e["period"]) ** 2
    forward = e["period"] * k[0] * k[0] if k[0] * k[0] > noise else 0.0
    lateral = e["period"] * k[1] * k[1] if k[1] * k[1] > noise else 0.0
    s["forward_excitation"] += forward
    s["lateral_excitation"] += lateral
    if e["mean_speed"] > p["epoch_reversing_speed"]:  # at walking pace the receiver shows hardly where it goes
        g["excitation"] += forward + lateral
    g["quiet"] = 0.0 if forward + lateral > 0 else g["quiet"] + e["period"]


@making
def judge_test(p, s, v, m):
    """Reason for which the finished test fails, REASON_NONE when it passes.

    What is confirmed is the average at the end, which knows 40 s more than the candidate: both must pass and agree.
    """
    if not v["error"] < v["limit"]:
        return REASON_DRIVE_TEST
    if not p["verification_by_energy"]:
        return REASON_NONE
    if not drive_error(v, m, s["average"], m["bias"]) < v["limit"]:
        return REASON_DRIVE_TEST
    d = np.empty(3)
    difference(s["average"], v["q_vs"], d)
    if d[0] ** 2 + d[1] ** 2 + d[2] ** 2 > p["verification_drift"] ** 2:
        return REASON_MOVED_ON
    return REASON_NONE


@plain
def sure(p, sigma):
    """The estimate is good enough to be confirmed."""
    return max(sigma[0], sigma[1]) < p["settling_tilt_sigma"] and sigma[2] < p["settling_yaw_sigma"]


@making
def verify(p, s, v, m, e, sigma, events, count):
    """Carry the running drive test on and decide when its time is up, and the estimate good enough."""
    if not drive_test(p, v, m, e):
        return count
    reason = judge_test(p, s, v, m)
    by_energy = p["verification_by_energy"]
    if reason == REASON_NONE and by_energy and not (sure(p, sigma) and s["agrees"] and trusted(p, m)):
        if v["elapsed"] < p["verification_longest"]:
            return count  # more of the same drive makes the test longer and the estimate better
        reason = REASON_UNSURE if s["agrees"] else REASON_SECOND_OPINION
    v["state"] = 2 if reason == REASON_NONE else 3
    code = PASSED if reason == REASON_NONE else FAILED
    count = write_test(events, count, e["t"], code, v, reason)
    if reason != REASON_NONE:
        s["progress"] = 0.0
        if not by_energy:
            soft_start(s)  # else the average, which already knows of the test, may be the next candidate
        return count
    if by_energy:
        v["q_vs"][:] = s["average"]
        v["bias"][:] = m["bias"]
        v["sigma"][:] = sigma
        v["error"] = drive_error(v, m, v["q_vs"], v["bias"])
    confirm(s, v, e["t"])
    return write_test(events, count, e["t"], CONFIRMED, v, REASON_NONE)


@plain
def recover_filter(p, m, a, s, d):
    """A filter far from a good second opinion, in angle or latency, has lost its way: it starts again from there."""
    good = math.isfinite(a["solved_time"]) and largest_sigma(a["covariance"]) < p["filter_recover_sigma"]
    if not p["filter_start_from_coarse"] or not good:
        return
    difference(m["q_vs"], a["q_vs"], d)
    angle = math.sqrt(d[0] ** 2 + d[1] ** 2 + d[2] ** 2)
    lost = not s["agrees"] and angle > 2.5 * p["settling_second_opinion_angle"]
    hypothesis = int(m["latency"] / p["epoch_latency_step"] + 0.5)
    late = abs(m["latency"] - a["latency"]) > p["filter_recover_latency"]
    if lost or (late and a["costs"][hypothesis] > p["filter_recover_cost"]):
        m["running"] = False
        soft_start(s)


@plain
def watch_axes(p, c, f, e):
    """Axes that repeat one value in motion while another moves, and readings at the end of the range."""
    period = e["period"]
    f["saturation"] *= math.exp(-period / p["fault_saturation_memory"])
    if e["flat_tops"] > 0:
        f["saturation"] += period
    moves = False
    for j in range(3):
        moves = moves or c["repeats"][j] < c["samples"] // 2
    for j in range(3):
        if moves and e["moving"] and c["samples"] > 3 and c["repeats"][j] >= c["samples"]:
            f["stuck_time"][j] += period
        elif e["moving"] or not moves:
            f["stuck_time"][j] = 0.0
        if f["stuck_time"][j] > p["fault_stuck_doubt"]:
            e["usable"] = False


@plain
def report_fault(p, f, which, holds, since, events, evidence, count):
    """Report a fault when it begins; it may be reported again once it was over."""
    bit = 1 << which
    if not holds:
        f["reported"] &= ~bit
        return count
    if f["reported"] & bit:
        return count
    f["reported"] |= bit
    row = events[count]
    evidence[count, :, :] = np.nan
    count = write_event(events, count, f["t"], FAULT, REASON_NONE)
    row[16] = since
    row[17] = which
    return count


@plain
def find_faults(p, c, a, f, e, events, evidence, count):
    """Faults of the sensor: mirrored axes, a stuck axis, readings at the end of the range."""
    watch_axes(p, c, f, e)
    f["t"] = e["t"]
    stuck = max(f["stuck_time"][0], f["stuck_time"][1], f["stuck_time"][2])
    long_stuck = stuck > p["fault_stuck_time"]
    saturated = f["saturation"] > p["fault_saturation_time"]
    if math.isfinite(a["solved_time"]):
        threshold = p["fault_mirror"] * min(noise_ratio(p, a), 4.0)  # contradictions of mirrored axes are noise, too
        if f["reported"] & (1 << LEFT_HANDED):
            threshold = p["fault_mirror_doubt"]
        mirrored = a["mirror"] > threshold
        count = report_fault(p, f, LEFT_HANDED, mirrored, np.nan, events, evidence, count)
    count = report_fault(p, f, STUCK_AXIS, long_stuck, e["t"] - stuck, events, evidence, count)
    return report_fault(p, f, SATURATED, saturated, np.nan, events, evidence, count)


@plain
def watch_looseness(p, f, g, t, changed, moved_on, events, evidence, count):
    """A device whose mounting changes again and again is loose: each change counts, and fades with the hours."""
    if changed or moved_on:
        since = t - f["restless_t"] if t > f["restless_t"] else 0.0
        faded = f["restlessness"] * math.exp(-since / p["fault_loose_memory"])
        f["restlessness"] = faded + (1.0 if changed else p["fault_moved_on_weight"])
        f["restless_t"] = t
    loose = f["restlessness"] > p["fault_loose"]
    reported = count
    count = report_fault(p, f, LOOSE, loose, f["restless_t"], events, evidence, count)
    if count > reported:
        write_evidence(evidence, reported, g)
        f["restlessness"] = 0.0
    return count


@plain
def align_coarsely(p, c, a, x, s, g, e, w):
    """Feed the coarse alignment with the epochs in motion."""
    if not (e["usable"] and e["moving"] and math.isfinite(e["yaw_rate"])):
        x["period"] = 0.0
    elif merge_epoch(p, c, x, e, w):
        k = w["k"]
        kinematics(x, k)
        update_coarse(p, a, x, k, w["b"])
        excite(p, s, g, x, k)


@plain
def process_epoch(p, c, a, x, mekf, s, v, g, f, e, w, events, evidence, count):
    """All stages in order for one epoch; gives the number of events so far."""
    m, sigma = mekf[0], w["sigma"]
    count = find_faults(p, c, a, f, e, events, evidence, count)
    align_coarsely(p, c, a, x, s, g, e, w)
    if not step_filter(p, c, m, a, e, w):
        return count
    mounting_sigma(p, m["covariance"], MOUNTING, noise_ratio(p, a), sigma)
    settle(p, s, m, a, e, sigma, w)
    if v["state"] == 1:
        before, elapsed = count, v["elapsed"]
        count = verify(p, s, v, m, e, sigma, events, count)
        tell_speed(p, v, m, e, elapsed)
        moved_on = count > before and events[before, 2] == REASON_MOVED_ON
        return watch_looseness(p, f, g, e["t"], False, moved_on, events, evidence, count)
    if s["stable"] and s["reliable"] and not s["confirmed"]:
        start_verification(v, s, m, sigma)
        return write_test(events, count, e["t"], STARTED, v, REASON_NONE)
    recover_filter(p, m, a, s, w["d"])
    if s["confirmed"] and math.isfinite(p["change_window"]) and watch_for_change(p, c, g, mekf, a, s, e, w):
        count = write_change(p, a, events, evidence, count, e["t"], mekf[1], s, g)
        count = watch_looseness(p, f, g, e["t"], True, False, events, evidence, count)
        begin_again(mekf, s, v, g)
    return count


# ------------------------------------------------------------------------------------------------------- reporting


@plain
def current_stage(c, m, s, v):
    """Stage as in `events.Stage`."""
    if s["confirmed"]:
        return 4
    if v["state"] == 1:
        return 3
    if m["running"]:
        return 2
    if math.isfinite(c["valid_fix_t"]) or math.isfinite(c["fix_t"]):
        return 1
    return 0


@plain
def current_needs(p, c, a, m, s, sigma, known):
    """Missing information as in `events.Needs`."""
    if not math.isfinite(c["t"]):
        return 1
    if not c["t"] - c["valid_fix_t"] < 10.0:
        return 2
    if s["confirmed"]:
        return 0
    needs = 0
    if not c["t"] - c["motion_t"] < 30.0:
        needs = 4
    wanted = 0.5 * p["settling_excitation"]
    yaw_missing = not known or sigma[2] > p["settling_yaw_sigma"]
    tilt_missing = not known or max(sigma[0], sigma[1]) > p["settling_tilt_sigma"]
    unproven = p["settling_reliable_yaw_rate"] == 0 and not s["right_handed"]
    if s["lateral_excitation"] < wanted and (yaw_missing or tilt_missing or unproven):
        needs |= 8
    if s["forward_excitation"] < wanted and yaw_missing:
        needs |= 16
    if needs == 0:
        needs = 8 if unproven else 32
    return needs


@making
def current_estimate(p, a, m, q, sigma):
    """Quaternion and sigma of the filter, else of the coarse alignment; False when there is none."""
    if m["running"]:
        sign = -1.0 if m["q_vs"][0] < 0 else 1.0
        for i in range(4):
            q[i] = sign * m["q_vs"][i]
        mounting_sigma(p, m["covariance"], MOUNTING, noise_ratio(p, a), sigma)
        return True
    q[:] = a["q_vs"]
    mounting_sigma(p, a["covariance"], 0, 1.0, sigma)
    return math.isfinite(a["solved_time"]) and largest_sigma(a["covariance"]) < p["coarse_report_sigma"]


@plain
def current_progress(p, c, m, s, v, sigma, known):
    """Share of the way done, 0..1, from sigma and the test; never falls but where it is reset."""
    now = 0.0
    if s["confirmed"]:
        now = 1.0
    elif v["state"] == 1:
        now = 0.6 + 0.4 * min(v["elapsed"] / p["verification_duration"], 1.0)
    elif math.isfinite(c["valid_fix_t"]):
        now = 0.05
        if known:
            start, goal = p["coarse_report_sigma"], p["settling_yaw_sigma"]
            worst = max(sigma[0], sigma[1], sigma[2])
            share = math.log(start / min(max(worst, goal), start)) / math.log(start / goal)
            now = 0.1 + (0.45 if m["running"] else 0.3) * share
    s["progress"] = max(s["progress"], now)
    return s["progress"]


@plain
def describe(p, c, a, m, s, v, row):
    """Write t, quaternion, sigma, stage, needs, stable, reliable, progress as they are; True with an estimate."""
    q, sigma = row[1:5], row[5:8]
    known = current_estimate(p, a, m, q, sigma)
    row[0] = c["t"]
    row[8] = current_stage(c, m, s, v)
    row[9] = current_needs(p, c, a, m, s, sigma, known)
    row[10] = s["stable"]
    row[11] = s["reliable"]
    row[12] = current_progress(p, c, m, s, v, sigma, known)
    return known


@plain
def stand(params, clock, coarse, mekf, settling, verification, row):
    """`describe` for Python, from which arrays come in many times as fast as records."""
    return describe(params[0], clock[0], coarse[0], mekf[0], settling[0], verification[0], row)


@plain
def report(p, c, a, m, s, v, rows, count):
    """Append a row of history when the interval has passed and there is an estimate."""
    if c["t"] < c["next_report"]:
        return count
    interval = p["report_interval"]
    c["next_report"] = (math.floor(c["t"] / interval + 1e-9) + 1) * interval
    return count + 1 if describe(p, c, a, m, s, v, rows[count]) else count


@plain
def write_speed(e, speeds, count):
    """Append the speeds of the drive test at the end of an epoch, when they are told."""
    if not math.isfinite(e["tested_speed"]):
        return count
    row = speeds[count]
    row[0] = e["t"]
    row[1] = e["speed"]
    row[2] = e["tested_speed"]
    row[3] = e["test_begins"]
    return count + 1


@plain
def run(
    params, clock, coarse, merged, mekf, settling, verification, change, faults, epochs, works,
    t, f_s, w_s, fix_row, fix_valid, fixes, rows, events, evidence, speeds, counts,
):  # fmt: skip
    """Take all samples of a chunk; mutates the state records; gives the number of rows, of events and of speeds."""
    p, c, a, x, m = params[0], clock[0], coarse[0], merged[0], mekf[0]
    s, v, g, f, e, w = settling[0], verification[0], change[0], faults[0], epochs[0], works[0]
    row_count, event_count, speed_count, next_fix, i = 0, 0, 0, 0, 0
    while i < t.shape[0]:
        stop = t.shape[0]
        if next_fix < fix_row.shape[0]:
            stop = fix_row[next_fix] + 1
        i = integrate(p, c, t, f_s, w_s, i, stop, counts)
        if i == stop and next_fix < fix_row.shape[0]:
            if fix_valid[next_fix] and t[i - 1] == c["t"]:
                end = take_fix(p, c, e, t[i - 1], fixes[next_fix], counts, w)
                if end == COMPLETE:
                    event_count = process_epoch(p, c, a, x, mekf, s, v, g, f, e, w, events, evidence, event_count)
                    speed_count = write_speed(e, speeds, speed_count)
                elif end == OUTAGE:  # nobody knows how the vehicle has turned meanwhile
                    mekf[0]["aligned"] = mekf[1]["aligned"] = False
                    x["period"] = 0.0
                if end != NO_EPOCH:
                    start_epoch(c, t[i - 1], e["next_speed"], e["next_course"])
            next_fix += 1
        row_count = report(p, c, a, m, s, v, rows, row_count)
    return row_count, event_count, speed_count
