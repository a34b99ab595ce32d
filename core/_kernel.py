"""Every numba function of the project: plain loops on records and scratch arrays.

This file imports nothing of the project, so that numba's cache, which watches a single file, can never be stale; record
layouts and parameters arrive as argument types. Records are explained in `state`, parameters in `params`, the method
with its equations in `docs/method.md`. The order here is the order of the flow chart (thesis 6.2).

Abbreviations: `p` parameters, `c` clock, `a` coarse alignment (accumulators), `m` filter, `s` settling, `v`
verification, `g` change; `e` the epoch at hand, `x` the longer one of the coarse alignment.
"""

import math

import numpy as np
from numba import njit

GRAVITY = 9.80665
"""m/s2, standard gravity"""
EARTH_RADIUS = 6371008.8
"""m, mean radius"""
REFERENCE_PERIOD = 0.25
"""s, the epoch for which the thesis gives its noises per step"""
RING_SPACING = 0.05
"""s"""

SPEED, ACCELERATION, YAW_RATE, ATTITUDE, MOUNTING, BIAS, GYRO_BIAS = 0, 1, 2, 3, 6, 9, 12
"""First index of each part of the error state."""
MEASUREMENTS = 11
"""specific force (3), velocity (3), yaw rate from the course, angular rate (3), yaw rate at standstill"""

DUPLICATE_TIME, BEFORE_PREVIOUS, FIX_WITHOUT_VELOCITY, FIX_IMPLAUSIBLE = range(4)
"""Reasons of rejection."""

STARTED, PASSED, FAILED, CONFIRMED, CHANGED = range(5)
"""Event codes."""
REASON_NONE, REASON_DRIVE_TEST, REASON_SECOND_OPINION = range(3)

EPOCH = np.dtype(
    [
        ("t", "f8"),  # s, its end
        ("period", "f8"),  # s
        ("speed", "f8"),  # m/s at its end
        ("mean_speed", "f8"),
        ("speed_change", "f8"),
        ("course", "f8"),  # rad at its end, nan = not trusted
        ("yaw_rate", "f8"),  # rad/s from the course, nan = not known
        ("lateral", "f8"),  # m/s2, speed times yaw rate
        ("climb", "f8"),  # m/s, nan = no altitude
        ("climb_height", "f8"),  # m gained
        ("grade", "f8"),  # sine of the slope
        ("moving", "?"),
        ("usable", "?"),
        ("f_s", "f8", (9, 3)),  # mean specific force, per latency hypothesis
        ("w_s", "f8", (9, 3)),
        ("gyro", "?"),
    ]
)
"""One epoch, the scratch record that passes from the clock to the stages."""


# ---------------------------------------------------------------------------------------------------- rotations


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def wrap(angle):
    """Angle in [-pi, pi)."""
    return angle - 2 * math.pi * np.floor((angle + math.pi) / (2 * math.pi))


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def begin_chain(c, t):
    """Start the integrated signal anew: after a gap nothing older may be averaged."""
    c["integral"][:] = 0.0
    c["ring_count"] = 0
    c["ring_head"] = -1
    c["fix_t"] = np.nan
    push_point(c, t)


@njit(cache=True, nogil=True)
def push_point(c, t):
    """Keep the integral at time t in the ring."""
    size = c["ring_t"].shape[0]
    head = (c["ring_head"] + 1) % size
    c["ring_head"] = head
    c["ring_count"] = min(c["ring_count"] + 1, size)
    c["ring_t"][head] = t
    for j in range(7):
        c["ring"][head, j] = c["integral"][j]


@njit(cache=True, nogil=True)
def integrate_sample(p, c, t, f_s, w_s):
    """Take one IMU sample: trapezoidal integral, a point in the ring every 50 ms."""
    no_gyro = 0.0
    if not (math.isfinite(w_s[0]) and math.isfinite(w_s[1]) and math.isfinite(w_s[2])):
        no_gyro = 1.0
    dt = t - c["t"]
    chained = dt <= p["epoch_max_sample_gap"]  # False for nan, the first sample of a session
    if chained:
        for j in range(3):
            rate = 0.0 if no_gyro > 0 else w_s[j]
            c["integral"][j] += 0.5 * dt * (c["f_s"][j] + f_s[j])
            c["integral"][3 + j] += 0.5 * dt * (c["w_s"][j] + rate)
        c["integral"][6] += 0.5 * dt * (c["no_gyro"] + no_gyro)
    for j in range(3):
        c["f_s"][j] = f_s[j]
        c["w_s"][j] = 0.0 if no_gyro > 0 else w_s[j]
    c["no_gyro"] = no_gyro
    c["t"] = t
    if not chained:
        begin_chain(c, t)
    elif t - c["ring_t"][c["ring_head"]] >= RING_SPACING:
        push_point(c, t)


@njit(cache=True, nogil=True)
def integral_at(c, t, out):
    """Integral at time t, linear between the points of the ring; False when t is not covered."""
    size = c["ring_t"].shape[0]
    head = c["ring_head"]
    newest = c["ring_t"][head]
    if t >= newest:
        span = c["t"] - newest
        weight = 0.0 if span <= 0 else min((t - newest) / span, 1.0)
        for j in range(7):
            out[j] = c["ring"][head, j] + weight * (c["integral"][j] - c["ring"][head, j])
        return True
    later = head
    for i in range(1, c["ring_count"]):
        earlier = (head - i) % size
        if c["ring_t"][earlier] <= t:
            weight = (t - c["ring_t"][earlier]) / (c["ring_t"][later] - c["ring_t"][earlier])
            for j in range(7):
                out[j] = c["ring"][earlier, j] + weight * (c["ring"][later, j] - c["ring"][earlier, j])
            return True
        later = earlier
    return False


@njit(cache=True, nogil=True)
def mean_signals(p, c, e, start, end, scratch):
    """Mean specific force and angular rate of [start, end], per latency hypothesis; False when not covered."""
    begin, stop = scratch[0], scratch[1]
    missing = 0.0
    for i in range(p["epoch_latency_count"]):
        shift = i * p["epoch_latency_step"]
        if i == 0:
            begin[:7] = c["fix_integral"]
            stop[:7] = c["integral"]
        elif not (integral_at(c, start - shift, begin) and integral_at(c, end - shift, stop)):
            return False
        for j in range(3):
            e["f_s"][i, j] = (stop[j] - begin[j]) / (end - start)
            e["w_s"][i, j] = (stop[3 + j] - begin[3 + j]) / (end - start)
        missing += stop[6] - begin[6]
    e["gyro"] = missing == 0.0
    return True


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def start_epoch(c, t, speed, course):
    """Let the next epoch begin at this fix."""
    c["fix_t"] = t
    c["fix_speed"] = speed
    c["fix_course"] = course
    c["fix_altitude"] = c["altitude"]
    c["fix_integral"][:] = c["integral"]


@njit(cache=True, nogil=True)
def describe_epoch(p, c, e, t, speed, course):
    """Kinematics between the fix that began the epoch and this one; False when it is a jump."""
    period = t - c["fix_t"]
    e["t"] = t
    e["period"] = period
    e["speed"] = speed
    e["mean_speed"] = 0.5 * (speed + c["fix_speed"])
    e["speed_change"] = speed - c["fix_speed"]
    slow = min(speed, c["fix_speed"]) < p["epoch_moving_speed"]
    e["moving"] = not slow
    e["course"] = np.nan if (slow and not p["filter_low_speed_course"]) else course
    e["yaw_rate"] = -wrap(course - c["fix_course"]) / period
    if slow and not p["filter_low_speed_course"]:
        e["yaw_rate"] = np.nan
    e["lateral"] = e["mean_speed"] * e["yaw_rate"]
    e["climb"] = c["climb"] if math.isfinite(c["altitude"]) else np.nan
    e["climb_height"] = c["altitude"] - c["fix_altitude"]
    e["grade"] = 0.0
    if math.isfinite(e["climb"]) and e["mean_speed"] > 3 * p["epoch_moving_speed"]:
        e["grade"] = min(max(e["climb"] / e["mean_speed"], -0.2), 0.2)
    if not math.isfinite(e["climb_height"]):
        e["climb_height"] = 0.0
    jump = abs(e["speed_change"]) > p["epoch_max_acceleration"] * period
    return not (jump or (e["moving"] and abs(e["yaw_rate"]) > p["epoch_max_yaw_rate"]))


@njit(cache=True, nogil=True)
def take_fix(p, c, e, t, fix, counts, scratch):
    """Turn a valid fix into an epoch; True when `e` holds one."""
    c["valid_fix_t"] = t
    velocity = scratch[2]
    if not velocity_of_fix(p, c, t, fix, velocity):
        counts[FIX_WITHOUT_VELOCITY] += 1
        return False
    speed, course = velocity[0], velocity[1]
    if speed < 0 or speed > p["epoch_max_speed"]:
        counts[FIX_IMPLAUSIBLE] += 1
        return False
    period = t - c["fix_t"]
    if period < p["epoch_min_epoch"]:
        return False
    smooth_altitude(p, c, t, fix)
    watch_direction(p, c, speed, course)
    if speed >= p["epoch_moving_speed"]:
        c["motion_t"] = t
    complete = False
    if period <= p["epoch_max_epoch"]:
        complete = describe_epoch(p, c, e, t, speed, course)
        if not complete:
            counts[FIX_IMPLAUSIBLE] += 1
        complete = complete and mean_signals(p, c, e, c["fix_t"], t, scratch)
        e["usable"] = complete and not c["reversing"]
    start_epoch(c, t, speed, course)
    return complete


# ------------------------------------------------------------------------------------------------ coarse alignment


@njit(cache=True, nogil=True)
def merge_epoch(p, m, e):
    """Merge an epoch into the longer one `m` that the coarse alignment uses; True when that is long enough.

    The noise of a speed difference counts less the longer the epoch, and driving shows little above 1 Hz.
    """
    if m["period"] >= p["coarse_min_epoch"]:
        m["period"] = 0.0
    before = m["period"] / (m["period"] + e["period"])
    m["speed_change"] = (m["speed_change"] if before > 0 else 0.0) + e["speed_change"]
    m["period"] += e["period"]
    m["mean_speed"] = mixed(before, m["mean_speed"], e["mean_speed"])
    m["yaw_rate"] = mixed(before, m["yaw_rate"], e["yaw_rate"])
    m["lateral"] = mixed(before, m["lateral"], e["lateral"])
    m["grade"] = mixed(before, m["grade"], e["grade"])
    m["gyro"] = e["gyro"] and (m["gyro"] or before == 0)
    for h in range(p["epoch_latency_count"]):
        for i in range(3):
            m["f_s"][h, i] = mixed(before, m["f_s"][h, i], e["f_s"][h, i])
            m["w_s"][h, i] = mixed(before, m["w_s"][h, i], e["w_s"][h, i])
    return m["period"] >= p["coarse_min_epoch"]


@njit(cache=True, nogil=True)
def mixed(share, x, y):
    """Mean of x and y, x with the given share."""
    return y if share == 0 else share * x + (1 - share) * y


@njit(cache=True, nogil=True)
def accumulate(p, a, e, k):
    """Add an epoch in motion to the sums: kinematic specific force k_v against mean specific force."""
    weight = e["period"]
    k[0] = e["speed_change"] / e["period"] + GRAVITY * e["grade"]
    k[1] = e["lateral"]
    k[2] = GRAVITY
    gyro = e["gyro"] and math.isfinite(p["coarse_gyro_noise_density"])
    a["time"] += weight
    for i in range(3):
        a["k"][i] += weight * k[i]
        for j in range(3):
            a["kk"][i, j] += weight * k[i] * k[j]
    for h in range(p["epoch_latency_count"]):
        for i in range(3):
            f = e["f_s"][h, i]
            a["f"][h, i] += weight * f
            a["ff"][h] += weight * f * f
            for j in range(3):
                a["fk"][h, i, j] += weight * f * k[j]
    if gyro:
        accumulate_gyro(p, a, e, weight)


@njit(cache=True, nogil=True)
def accumulate_gyro(p, a, e, weight):
    """Add the pair angular rate, yaw rate from the course, which is the noisier the slower the vehicle."""
    rate = e["yaw_rate"]
    course_noise = 2 * (p["filter_speed_noise"] / e["mean_speed"]) ** 2 / e["period"]
    weight *= p["coarse_gyro_noise_density"] / (p["coarse_gyro_noise_density"] + course_noise)
    a["gyro_time"] += weight
    a["r"] += weight * rate
    a["rr"] += weight * rate * rate
    for h in range(p["epoch_latency_count"]):
        for i in range(3):
            w = e["w_s"][h, i]
            a["w"][h, i] += weight * w
            a["wr"][h, i] += weight * w * rate
            a["ww"][h] += weight * w * w


@njit(cache=True, nogil=True)
def forget(a, factor):
    """Scale all sums, so that old epochs count less."""
    a["time"] *= factor
    a["solved_time"] *= factor
    a["k"][:] *= factor
    a["kk"][:] *= factor
    a["f"][:] *= factor
    a["fk"][:] *= factor
    a["ff"][:] *= factor
    a["gyro_time"] *= factor
    a["r"] *= factor
    a["rr"] *= factor
    a["w"][:] *= factor
    a["wr"][:] *= factor
    a["ww"][:] *= factor


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def best_rotation(b, q):
    """Wahba's problem by Horn's quaternion: k ~ R(q) f for b = sum f k'; gives the largest eigenvalue."""
    n = np.empty((4, 4))
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
    values, vectors = np.linalg.eigh(n)
    sign = -1.0 if vectors[0, 3] < 0 else 1.0
    for i in range(4):
        q[i] = sign * vectors[i, 3]
    return values[3]


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def choose_latency(p, a, prior, noise, gyro_noise):
    """The hypothesis with the smallest residual, refined by a parabola through its neighbours; gives that residual."""
    count = p["epoch_latency_count"]
    b = np.empty((3, 3))
    q = np.empty(4)
    costs = np.empty(count)
    for h in range(count):
        costs[h] = profile_matrix(a, h, prior, noise, gyro_noise, b)
        costs[h] -= 2 * best_rotation(b, q)
    best = 0
    for h in range(1, count):
        if costs[h] < costs[best]:
            best = h
    offset = 0.0
    if 0 < best < count - 1:
        curvature = costs[best - 1] - 2 * costs[best] + costs[best + 1]
        if curvature > 0:
            offset = 0.5 * (costs[best - 1] - costs[best + 1]) / curvature
    a["hypothesis"] = best
    a["latency"] = (best + offset) * p["epoch_latency_step"]
    return costs[best]


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def update_coarse(p, a, e, k, b):
    """Accumulate an epoch in motion and solve again once in a while; True when there is a new solution."""
    accumulate(p, a, e, k)
    since = a["time"] - a["solved_time"]
    if a["time"] < p["coarse_min_time"] or since < p["coarse_interval"]:
        return False
    interval = p["coarse_interval"]
    choose = p["epoch_latency_count"] > 1 and math.floor(a["time"] / (5 * interval)) != math.floor(
        (a["time"] - e["period"]) / (5 * interval)
    )
    solve_coarse(p, a, b, choose or not math.isfinite(a["solved_time"]))
    return True


@njit(cache=True, nogil=True)
def largest_sigma(covariance):
    """Largest of the three axis sigmas, rad."""
    return math.sqrt(max(covariance[0, 0], covariance[1, 1], covariance[2, 2]))


# ---------------------------------------------------------------------------------------------------------- filter


@njit(cache=True, nogil=True)
def add_process_noise(p, cov, period, speed, yaw_rate):
    """Q of (4.63)-(4.70); per-step noises of the thesis scaled to the length of the epoch."""
    steps = period / REFERENCE_PERIOD
    sigma = p["filter_acceleration_noise"]
    cross = sigma * period**2 * p["filter_cross_noise_factor"]
    cov[SPEED, SPEED] += sigma * period**3 * p["filter_speed_noise_factor"]
    cov[SPEED, ACCELERATION] += cross
    cov[ACCELERATION, SPEED] += cross
    cov[ACCELERATION, ACCELERATION] += sigma * period
    cov[YAW_RATE, YAW_RATE] += (
        p["filter_yaw_rate_noise"] * period + p["filter_yaw_rate_noise_per_speed"] * speed**2 * steps
    )
    decay = math.exp(-period / p["filter_tilt_time_constant"])
    tilt = (1 - decay * decay) * p["filter_tilt_sigma"] ** 2
    attitude = p["filter_attitude_noise_per_yaw_rate"] * yaw_rate**2 * steps
    cov[ATTITUDE, ATTITUDE] += attitude + tilt
    cov[ATTITUDE + 1, ATTITUDE + 1] += attitude + tilt
    cov[ATTITUDE + 2, ATTITUDE + 2] += attitude + p["filter_heading_noise"] * period
    mounting = p["filter_mounting_noise_per_yaw_rate"] * yaw_rate**2 * steps + p["filter_mounting_noise"] * period
    for i in range(3):
        cov[MOUNTING + i, MOUNTING + i] += mounting
        cov[BIAS + i, BIAS + i] += p["filter_bias_noise"] * period


@njit(cache=True, nogil=True)
def set_heading(m, course):
    """Level attitude with the heading of a course (clockwise from north)."""
    half = 0.5 * (0.5 * math.pi - course)
    m["q_nv"][0] = math.cos(half)
    m["q_nv"][1] = 0.0
    m["q_nv"][2] = 0.0
    m["q_nv"][3] = math.sin(half)


@njit(cache=True, nogil=True)
def begin_motion(p, m, speed, course):
    """Forget the motion and the attitude of the vehicle, keep mounting and biases: start, outage, reversing."""
    m["speed"] = speed
    m["acceleration"] = 0.0
    m["yaw_rate"] = 0.0
    set_heading(m, course)
    cov = m["covariance"]
    for i in range(MOUNTING):
        for j in range(cov.shape[0]):
            cov[i, j] = 0.0
            cov[j, i] = 0.0
    cov[SPEED, SPEED] = (2 * p["filter_speed_noise"]) ** 2
    cov[ACCELERATION, ACCELERATION] = 1.0
    cov[YAW_RATE, YAW_RATE] = 0.1**2
    cov[ATTITUDE, ATTITUDE] = cov[ATTITUDE + 1, ATTITUDE + 1] = p["filter_tilt_sigma"] ** 2
    cov[ATTITUDE + 2, ATTITUDE + 2] = (2 * p["filter_speed_noise"] / max(speed, 0.5)) ** 2
    m["aligned"] = True


@njit(cache=True, nogil=True)
def start_from_coarse(p, m, a, speed, course):
    """Start the filter at the coarse alignment."""
    cov = m["covariance"]
    cov[:] = 0.0
    m["q_vs"][:] = a["q_vs"]
    m["bias"][:] = a["bias"]
    m["gyro_bias"][:] = 0.0
    begin_motion(p, m, speed, course)
    for i in range(3):
        for j in range(3):
            cov[MOUNTING + i, MOUNTING + j] = a["covariance"][i, j]
        cov[BIAS + i, BIAS + i] = p["filter_bias_sigma"] ** 2
        cov[GYRO_BIAS + i, GYRO_BIAS + i] = p["filter_gyro_bias_sigma"] ** 2
    m["running"] = True


@njit(cache=True, nogil=True)
def start_at_identity(p, m):
    """Start as in thesis 5.2: x = 0, P = Q, both quaternions 1 in the frames of the thesis.

    Heading north, and sensor axes along forward, right, down. The heading follows from the first course in motion.
    """
    m["covariance"][:] = 0.0
    m["speed"] = 0.0
    m["acceleration"] = 0.0
    m["yaw_rate"] = 0.0
    set_heading(m, 0.0)
    m["q_vs"][:] = 0.0
    m["q_vs"][1] = 1.0
    add_process_noise(p, m["covariance"], REFERENCE_PERIOD, 1.0, 1.0)
    m["running"] = True
    m["aligned"] = False


@njit(cache=True, nogil=True)
def level_out(m, keep):
    """Let roll and pitch of the vehicle decay towards level by the factor `keep`; the heading stays."""
    r = np.empty((3, 3))
    rotation_matrix(m["q_nv"], r)
    turn(m["q_nv"], (1 - keep) * r[1, 2], -(1 - keep) * r[0, 2], 0.0)


@njit(cache=True, nogil=True)
def predict(p, m, period):
    """Prediction (4.37)-(4.51) with the turn folded into the reference attitude at once."""
    cov = m["covariance"]
    size = cov.shape[0]
    angle = period * m["yaw_rate"]
    keep = math.exp(-period / p["filter_tilt_time_constant"])
    m["speed"] += period * m["acceleration"]
    turn(m["q_nv"], 0.0, 0.0, angle)
    if keep < 1:
        level_out(m, keep)
    cosine, sine = math.cos(angle), math.sin(angle)
    for j in range(size):
        x, y = cov[ATTITUDE, j], cov[ATTITUDE + 1, j]
        cov[SPEED, j] += period * cov[ACCELERATION, j]
        cov[ATTITUDE, j] = keep * (cosine * x - sine * y)
        cov[ATTITUDE + 1, j] = keep * (sine * x + cosine * y)
        cov[ATTITUDE + 2, j] += period * cov[YAW_RATE, j]
    for i in range(size):
        x, y = cov[i, ATTITUDE], cov[i, ATTITUDE + 1]
        cov[i, SPEED] += period * cov[i, ACCELERATION]
        cov[i, ATTITUDE] = keep * (cosine * x - sine * y)
        cov[i, ATTITUDE + 1] = keep * (sine * x + cosine * y)
        cov[i, ATTITUDE + 2] += period * cov[i, YAW_RATE]
    add_process_noise(p, cov, period, m["speed"], m["yaw_rate"])


@njit(cache=True, nogil=True)
def predict_measurements(m, z, h):
    """Z = h(x) and its Jacobian: specific force (4.55), velocity (4.59), yaw rate (4.60), angular rate."""
    r_nv = np.empty((3, 3))
    r_vs = np.empty((3, 3))
    u = np.empty(3)
    rotation_matrix(m["q_nv"], r_nv)
    rotation_matrix(m["q_vs"], r_vs)
    speed, rate = m["speed"], m["yaw_rate"]
    u[0] = GRAVITY * r_nv[2, 0] + m["acceleration"]
    u[1] = GRAVITY * r_nv[2, 1] + speed * rate
    u[2] = GRAVITY * r_nv[2, 2]
    h[:] = 0.0
    for i in range(3):
        x, y, w = r_vs[0, i], r_vs[1, i], r_vs[2, i]
        z[i] = x * u[0] + y * u[1] + w * u[2] + m["bias"][i]
        h[i, SPEED] = y * rate
        h[i, ACCELERATION] = x
        h[i, YAW_RATE] = y * speed
        for j in range(2):  # R_sn [g e_z x]
            column = x * r_nv[1 - j, 0] + y * r_nv[1 - j, 1] + w * r_nv[1 - j, 2]
            h[i, ATTITUDE + j] = GRAVITY * column * (1.0 if j == 0 else -1.0)
        h[i, MOUNTING] = y * u[2] - w * u[1]
        h[i, MOUNTING + 1] = w * u[0] - x * u[2]
        h[i, MOUNTING + 2] = x * u[1] - y * u[0]
        h[i, BIAS + i] = 1.0
        z[7 + i] = w * rate + m["gyro_bias"][i]
        h[7 + i, YAW_RATE] = w
        h[7 + i, MOUNTING] = y * rate
        h[7 + i, MOUNTING + 1] = -x * rate
        h[7 + i, GYRO_BIAS + i] = 1.0
        z[3 + i] = r_nv[i, 0] * speed
        h[3 + i, SPEED] = r_nv[i, 0]
    h[3, ATTITUDE + 1] = z[5]
    h[3, ATTITUDE + 2] = -z[4]
    h[4, ATTITUDE] = -z[5]
    h[4, ATTITUDE + 2] = z[3]
    h[5, ATTITUDE] = z[4]
    h[5, ATTITUDE + 1] = -z[3]
    z[6] = rate
    h[6, YAW_RATE] = 1.0
    z[10] = rate
    h[10, YAW_RATE] = 1.0


@njit(cache=True, nogil=True)
def observe(p, e, f_s, w_s, y, noise):
    """Fill the measurements y and their standard deviations; infinite = not measured in this epoch."""
    noise[:] = np.inf
    y[:] = 0.0
    for i in range(3):
        y[i] = f_s[i]
        noise[i] = p["filter_accelerometer_noise"]
    if math.isfinite(e["course"]):
        y[3] = e["speed"] * math.sin(e["course"])
        y[4] = e["speed"] * math.cos(e["course"])
        noise[3] = noise[4] = p["filter_speed_noise"]
    if math.isfinite(e["climb"]):
        y[5] = e["climb"]
        noise[5] = p["filter_climb_noise"]
    if math.isfinite(e["yaw_rate"]):
        y[6] = e["yaw_rate"]
        noise[6] = p["filter_course_rate_noise"]
    if e["gyro"]:
        for i in range(3):
            y[7 + i] = w_s[i]
            noise[7 + i] = p["filter_gyro_noise"]
    if e["mean_speed"] < 0.3 * p["epoch_moving_speed"]:
        noise[10] = p["filter_standstill_yaw_rate_noise"]


@njit(cache=True, nogil=True)
def update(p, m, e, f_s, w_s):
    """Update (4.18)-(4.23): scalar after scalar about one point of linearisation, the same as all at once."""
    cov = m["covariance"]
    size = cov.shape[0]
    z, y, noise = np.empty(MEASUREMENTS), np.empty(MEASUREMENTS), np.empty(MEASUREMENTS)
    h = np.empty((MEASUREMENTS, size))
    dx, ph = np.zeros(size), np.empty(size)
    predict_measurements(m, z, h)
    observe(p, e, f_s, w_s, y, noise)
    if not math.isfinite(noise[3]):  # no course: the speed alone, along the vehicle
        h[3, :] = 0.0
        h[3, SPEED] = 1.0
        y[3], z[3], noise[3] = e["speed"], m["speed"], p["filter_speed_noise"]
    for row in range(MEASUREMENTS):
        if not math.isfinite(noise[row]):
            continue
        innovation = y[row] - z[row]
        variance = 0.0
        for i in range(size):
            total = 0.0
            for j in range(size):
                total += cov[i, j] * h[row, j]
            ph[i] = total
            innovation -= h[row, i] * dx[i]
            variance += h[row, i] * total
        total = variance + noise[row] ** 2
        if innovation * innovation > p["filter_gate"] ** 2 * total:
            total = innovation * innovation / p["filter_gate"] ** 2
        for i in range(size):
            dx[i] += ph[i] * innovation / total
            for j in range(i + 1):
                cov[i, j] -= ph[i] * ph[j] / total
                cov[j, i] = cov[i, j]
    fold(m, dx)


@njit(cache=True, nogil=True)
def fold(m, dx):
    """Fold the error state into the references and reset it (4.29), (4.30); the speed stays positive."""
    m["speed"] = max(m["speed"] + dx[SPEED], 0.0)
    m["acceleration"] += dx[ACCELERATION]
    m["yaw_rate"] += dx[YAW_RATE]
    turn(m["q_nv"], dx[ATTITUDE], dx[ATTITUDE + 1], dx[ATTITUDE + 2])
    turn(m["q_vs"], dx[MOUNTING], dx[MOUNTING + 1], dx[MOUNTING + 2])
    for i in range(3):
        m["bias"][i] += dx[BIAS + i]
        m["gyro_bias"][i] += dx[GYRO_BIAS + i]


@njit(cache=True, nogil=True)
def shifted_signals(p, a, e, f_s, w_s):
    """Mean signals of the epoch at the refined latency, between the two nearest hypotheses."""
    position = min(max(a["latency"] / p["epoch_latency_step"], 0.0), p["epoch_latency_count"] - 1.0)
    low = min(int(position), max(p["epoch_latency_count"] - 2, 0))
    weight = position - low
    high = min(low + 1, p["epoch_latency_count"] - 1)
    for i in range(3):
        f_s[i] = (1 - weight) * e["f_s"][low, i] + weight * e["f_s"][high, i]
        w_s[i] = (1 - weight) * e["w_s"][low, i] + weight * e["w_s"][high, i]


@njit(cache=True, nogil=True)
def step_filter(p, m, a, e, f_s, w_s):
    """One epoch: start where it can be started, else predict and update; True when the filter made a step."""
    if not e["usable"]:
        m["aligned"] = False
        return False
    heading_known = e["moving"] and math.isfinite(e["course"])
    if not m["running"]:
        if not p["filter_start_from_coarse"]:
            start_at_identity(p, m)
        elif (
            heading_known
            and math.isfinite(a["solved_time"])
            and largest_sigma(a["covariance"]) < p["filter_start_sigma"]
        ):
            start_from_coarse(p, m, a, e["speed"], e["course"])
            return True
        else:
            return False
    if not m["aligned"]:
        if not p["filter_start_from_coarse"]:
            if heading_known:
                set_heading(m, e["course"])
                m["aligned"] = True
        elif heading_known:
            begin_motion(p, m, e["speed"], e["course"])
            return True
        else:
            return False
    predict(p, m, e["period"])
    update(p, m, e, f_s, w_s)
    return True


# ----------------------------------------------------------------------------------- settling, verification, change


@njit(cache=True, nogil=True)
def mounting_sigma(p, covariance, offset, sigma):
    """1 sigma about the vehicle axes, with what the model leaves out added in square."""
    for i in range(3):
        sigma[i] = math.sqrt(covariance[offset + i, offset + i] + p["settling_systematic_sigma"] ** 2)


@njit(cache=True, nogil=True)
def move_average(p, s, q, period):
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
    mean, step = np.zeros(4), np.empty(3)
    for back in range(used):
        for i in range(4):
            mean[i] += s["ring"][(head - back) % size, i]
    norm = math.sqrt(mean[0] ** 2 + mean[1] ** 2 + mean[2] ** 2 + mean[3] ** 2)
    sign = -1.0 if mean[0] < 0 else 1.0
    mean *= sign / norm
    difference(mean, s["average"], step)
    s["average"][:] = mean
    if used < wanted:
        return np.inf
    return math.sqrt(step[0] ** 2 + step[1] ** 2 + step[2] ** 2) / period


@njit(cache=True, nogil=True)
def second_opinion(p, m, a):
    """Filter and coarse alignment agree, within their sigmas and within an angle."""
    if not math.isfinite(a["solved_time"]):
        return False
    d, total = np.empty(3), np.empty((3, 3))
    difference(m["q_vs"], a["q_vs"], d)
    for i in range(3):
        for j in range(3):
            total[i, j] = m["covariance"][MOUNTING + i, MOUNTING + j] + a["covariance"][i, j]
        total[i, i] += 2 * p["settling_systematic_sigma"] ** 2 + 1e-12
    near = d[0] ** 2 + d[1] ** 2 + d[2] ** 2 < p["settling_second_opinion_angle"] ** 2
    return near and mahalanobis(d, total) < 3 * p["settling_second_opinion_sigmas"] ** 2


@njit(cache=True, nogil=True)
def settle(p, s, m, a, e, sigma):
    """STABLE and RELIABLE."""
    s["stable"] = move_average(p, s, m["q_vs"], e["period"]) < p["settling_stable_rate"]
    if p["settling_reliable_yaw_rate"] > 0:
        turning = e["moving"] and abs(e["yaw_rate"]) > p["settling_reliable_yaw_rate"]
        s["reliable"] = s["reliable"] or turning
        s["agrees"] = True
        return
    s["agrees"] = second_opinion(p, m, a)
    informed = max(sigma[0], sigma[1]) < p["settling_tilt_sigma"] and sigma[2] < p["settling_yaw_sigma"]
    excited = s["forward_excitation"] + s["lateral_excitation"] > p["settling_excitation"]
    s["reliable"] = informed and excited and s["agrees"]


@njit(cache=True, nogil=True)
def soft_start(s):
    """Soft initialisation (thesis 6.2): the booleans are reset, the filter goes on."""
    s["stable"] = False
    s["reliable"] = False
    s["count"] = 0


@njit(cache=True, nogil=True)
def start_verification(v, s, m, sigma):
    """Save the candidate and start the drive test."""
    v["state"] = 1
    v["q_vs"][:] = s["average"]
    v["bias"][:] = m["bias"]
    v["sigma"][:] = sigma
    v["elapsed"] = 0.0
    v["distance"] = 0.0
    v["excess"] = 0.0
    v["error"] = 0.0
    soft_start(s)


@njit(cache=True, nogil=True)
def drive_test(p, v, e, f_s):
    """Integrate the candidate's forward specific force against the GPS (5.6); True when the time is up."""
    r = np.empty((3, 3))
    rotation_matrix(v["q_vs"], r)
    forward = 0.0
    for i in range(3):
        forward += r[0, i] * (f_s[i] - v["bias"][i])
    period = e["period"]
    if p["verification_by_energy"]:
        if not e["moving"]:
            return False
        v["excess"] += e["mean_speed"] * (forward * period - e["speed_change"]) - GRAVITY * e["climb_height"]
        v["distance"] += e["mean_speed"] * period
        v["elapsed"] += period
        v["error"] = abs(v["excess"]) * v["elapsed"] / max(v["distance"], 1e-9)
    else:
        v["excess"] += forward * period - e["speed_change"]
        v["elapsed"] += period
        v["error"] = abs(v["excess"])
    return v["elapsed"] >= p["verification_duration"]


@njit(cache=True, nogil=True)
def confirm(s, v, t):
    """Keep the verified candidate as the mounting."""
    s["confirmed"] = True
    s["has_mount"] = True
    s["suspect"] = False
    s["mount_t"] = t
    s["mount_q_vs"][:] = v["q_vs"]
    s["mount_sigma"][:] = v["sigma"]
    s["mount_error"] = v["error"]


@njit(cache=True, nogil=True)
def clear_sums(a):
    """Empty the accumulators of a coarse alignment; latency and noise stay known."""
    forget(a, 0.0)
    a["solved_time"] = np.nan


@njit(cache=True, nogil=True)
def look_for_change(p, g, w, s):
    """Cumulative sum of what the fresh window says against the confirmed mounting; True when it decides."""
    d, total = np.empty(3), np.empty((3, 3))
    difference(w["q_vs"], s["mount_q_vs"], d)
    for i in range(3):
        for j in range(3):
            total[i, j] = w["covariance"][i, j]
        total[i, i] += s["mount_sigma"][i] ** 2 + p["settling_systematic_sigma"] ** 2
    distance = mahalanobis(d, total)
    before = g["evidence"]
    gain = min(distance - p["change_allowance"], p["change_cap"])
    if gain > 0 or largest_sigma(w["covariance"]) < p["change_acquit_sigma"]:  # a young window cannot acquit
        g["evidence"] = max(0.0, before + gain)
    if before == 0.0 and g["evidence"] > 0.0:
        clear_sums(w)  # from here on only data from after the first suspicion count
        g["looked_time"] = 0.0
        return False
    angle = math.sqrt(d[0] ** 2 + d[1] ** 2 + d[2] ** 2)
    return g["evidence"] > p["change_threshold"] and angle > p["change_min_angle"]


@njit(cache=True, nogil=True)
def watch_for_change(p, g, w, s, a, e, k, b):
    """Feed the forgetting window and look at it every few seconds of motion; True when the device has moved."""
    forget(w, math.exp(-e["period"] / p["change_window"]))
    g["looked_time"] *= math.exp(-e["period"] / p["change_window"])
    accumulate(p, w, e, k)
    if w["time"] - g["looked_time"] < p["change_interval"]:
        return False
    g["looked_time"] = w["time"]
    w["hypothesis"] = a["hypothesis"]
    w["noise_density"] = max(a["noise_density"], w["noise_density"])
    solve_coarse(p, w, b, False)
    return look_for_change(p, g, w, s)


@njit(cache=True, nogil=True)
def begin_again(a, w, m, s, v, g):
    """After an orientation change: the window becomes the coarse alignment, everything else starts anew."""
    a["time"] = w["time"]
    a["k"][:] = w["k"]
    a["kk"][:] = w["kk"]
    a["f"][:] = w["f"]
    a["fk"][:] = w["fk"]
    a["ff"][:] = w["ff"]
    a["gyro_time"] = w["gyro_time"]
    a["r"] = w["r"]
    a["rr"] = w["rr"]
    a["w"][:] = w["w"]
    a["wr"][:] = w["wr"]
    a["ww"][:] = w["ww"]
    a["q_vs"][:] = w["q_vs"]
    a["covariance"][:] = w["covariance"]
    a["solved_time"] = w["time"]
    clear_sums(w)
    m["running"] = False
    soft_start(s)
    s["confirmed"] = False
    s["suspect"] = True
    s["forward_excitation"] = 0.0
    s["lateral_excitation"] = 0.0
    s["progress"] = 0.0
    v["state"] = 0
    v["elapsed"] = 0.0
    v["error"] = 0.0
    g["evidence"] = 0.0
    g["looked_time"] = 0.0


@njit(cache=True, nogil=True)
def write_event(events, count, t, code, q, sigma, elapsed, error, angle, reason):
    """Append a row: t, code, quaternion, sigma, elapsed, error, angle, reason."""
    row = events[count]
    row[0] = t
    row[1] = code
    for i in range(4):
        row[2 + i] = q[i]
    for i in range(3):
        row[6 + i] = sigma[i]
    row[9] = elapsed
    row[10] = error
    row[11] = angle
    row[12] = reason
    return count + 1


@njit(cache=True, nogil=True)
def excite(p, s, e, k):
    """Sum the squared horizontal acceleration above the noise of the fixes."""
    noise = (p["filter_speed_noise"] / e["period"]) ** 2
    s["forward_excitation"] += e["period"] * max(k[0] * k[0] - noise, 0.0)
    s["lateral_excitation"] += e["period"] * max(k[1] * k[1] - noise, 0.0)


@njit(cache=True, nogil=True)
def verify(p, s, v, e, f_s, events, count):
    """Carry the running drive test on and decide when its time is up."""
    if not drive_test(p, v, e, f_s):
        return count
    passed = v["error"] < p["verification_limit"]
    reason = REASON_NONE if passed else REASON_DRIVE_TEST
    if passed and not s["agrees"]:
        passed = False
        reason = REASON_SECOND_OPINION
    code = PASSED if passed else FAILED
    v["state"] = 2 if passed else 3
    count = write_event(events, count, e["t"], code, v["q_vs"], v["sigma"], v["elapsed"], v["error"], np.nan, reason)
    if passed:
        confirm(s, v, e["t"])
        return write_event(
            events, count, e["t"], CONFIRMED, v["q_vs"], v["sigma"], v["elapsed"], v["error"], np.nan, REASON_NONE
        )
    s["progress"] = 0.0
    soft_start(s)
    return count


@njit(cache=True, nogil=True)
def recover_filter(p, m, a, s):
    """A filter far from a good second opinion has lost its way: start it again from there."""
    good = math.isfinite(a["solved_time"]) and largest_sigma(a["covariance"]) < 0.5 * p["filter_start_sigma"]
    if not p["filter_start_from_coarse"] or s["agrees"] or not good:
        return
    d = np.empty(3)
    difference(m["q_vs"], a["q_vs"], d)
    if d[0] ** 2 + d[1] ** 2 + d[2] ** 2 > (2.5 * p["settling_second_opinion_angle"]) ** 2:
        m["running"] = False
        soft_start(s)


@njit(cache=True, nogil=True)
def process_epoch(p, a, w, x, m, s, v, g, e, scratch, b, events, count):
    """All stages in order for one epoch; gives the number of events so far."""
    f_s, w_s, k, sigma = scratch[3][:3], scratch[4][:3], scratch[5][:3], scratch[6][:3]
    informative = e["usable"] and e["moving"] and math.isfinite(e["yaw_rate"])
    if not informative:
        x["period"] = 0.0
    elif merge_epoch(p, x, e):
        update_coarse(p, a, x, k, b)
        excite(p, s, x, k)
        if s["confirmed"] and math.isfinite(p["change_window"]) and watch_for_change(p, g, w, s, a, x, k, b):
            d = np.empty(3)
            difference(w["q_vs"], s["mount_q_vs"], d)
            angle = math.sqrt(d[0] ** 2 + d[1] ** 2 + d[2] ** 2)
            mounting_sigma(p, w["covariance"], 0, sigma)
            count = write_event(events, count, e["t"], CHANGED, w["q_vs"], sigma, 0.0, 0.0, angle, REASON_NONE)
            begin_again(a, w, m, s, v, g)
            return count
    shifted_signals(p, a, e, f_s, w_s)
    if not step_filter(p, m, a, e, f_s, w_s):
        return count
    mounting_sigma(p, m["covariance"], MOUNTING, sigma)
    settle(p, s, m, a, e, sigma)
    if v["state"] == 1:
        return verify(p, s, v, e, f_s, events, count)
    if s["stable"] and s["reliable"] and not s["confirmed"]:
        start_verification(v, s, m, sigma)
        return write_event(events, count, e["t"], STARTED, v["q_vs"], v["sigma"], 0.0, 0.0, np.nan, REASON_NONE)
    recover_filter(p, m, a, s)
    return count


# ------------------------------------------------------------------------------------------------------- reporting


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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
    if not known or sigma[2] > p["settling_yaw_sigma"] or not s["reliable"]:
        if s["lateral_excitation"] < wanted:
            needs |= 8
        if s["forward_excitation"] < wanted:
            needs |= 16
    if needs == 0:
        needs = 32
    return needs


@njit(cache=True, nogil=True)
def current_estimate(p, a, m, q, sigma):
    """Quaternion and sigma of the filter, else of the coarse alignment; False when there is none."""
    if m["running"]:
        sign = -1.0 if m["q_vs"][0] < 0 else 1.0
        for i in range(4):
            q[i] = sign * m["q_vs"][i]
        mounting_sigma(p, m["covariance"], MOUNTING, sigma)
        return True
    q[:] = a["q_vs"]
    mounting_sigma(p, a["covariance"], 0, sigma)
    return math.isfinite(a["solved_time"]) and largest_sigma(a["covariance"]) < p["coarse_report_sigma"]


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def report(p, c, a, m, s, v, rows, count):
    """Append a row of history when the interval has passed and there is an estimate."""
    if c["t"] < c["next_report"]:
        return count
    if not describe(p, c, a, m, s, v, rows[count]):
        return count
    interval = p["report_interval"]
    c["next_report"] = (math.floor(c["t"] / interval + 1e-9) + 1) * interval
    return count + 1


@njit(cache=True, nogil=True)
def run(
    params, clock, coarse, window, merged, mekf, settling, verification, change, epochs,
    t, f_s, w_s, fix_row, fix_valid, fixes, rows, events, counts,
):  # fmt: skip
    """Take all samples of a chunk; mutates the state records; gives the number of rows and of events."""
    p, c, a, w, x, m = params[0], clock[0], coarse[0], window[0], merged[0], mekf[0]
    s, v, g, e = settling[0], verification[0], change[0], epochs[0]
    scratch = np.zeros((8, 8))
    b = np.zeros((3, 3))
    row_count, event_count, next_fix = 0, 0, 0
    for i in range(t.shape[0]):
        fix = -1
        if next_fix < fix_row.shape[0] and fix_row[next_fix] == i:
            fix = next_fix
            next_fix += 1
        if t[i] == c["t"]:
            counts[DUPLICATE_TIME] += 1
        elif t[i] < c["t"]:
            counts[BEFORE_PREVIOUS] += 1
            continue
        else:
            integrate_sample(p, c, t[i], f_s[i], w_s[i])
        if fix >= 0 and fix_valid[fix] and take_fix(p, c, e, t[i], fixes[fix], counts, scratch):
            event_count = process_epoch(p, a, w, x, m, s, v, g, e, scratch, b, events, event_count)
        row_count = report(p, c, a, m, s, v, rows, row_count)
    return row_count, event_count
