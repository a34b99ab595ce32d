"""The numba functions of the events; imports nothing of the project, so that numba's cache is never stale.

What is cheap is done at every sample on local numbers; what is rare (a pulse, a manoeuvre, a pothole that goes on) in
functions on the state's record `r`. `p` is the record of the parameters, an output row is `OUT` below.
"""

import math

import numpy as np
from numba import njit

GRAVITY = 9.80665
IDLE, PULSE, AFTER = range(3)
IMPACT, BRAKING, ACCELERATION, CORNERING, POTHOLE = range(5)
OUT = 9
"""kind, t, start, duration, peak, direction, change of the velocity forward and to the left, speed"""
SPEED, COURSE = 3, 4
FLAT, FLAT_LEAST = 3e-3, 30.0
"""An axis at the end of its range repeats itself within this share, at this many m/s2 or more."""
COURSES = 32
COURSES_X = np.cos(2.0 * np.pi * np.arange(COURSES) / COURSES)
COURSES_Y = np.sin(2.0 * np.pi * np.arange(COURSES) / COURSES)
"""Directions a push is compared with where the accelerometer's range ends."""


@njit(cache=True, nogil=True)
def run(p, r, turn, ts, fs, ws, fix_row, fix_valid, fix, first, out):
    """Go on from sample `first` until the end or `out` is full; gives where to go on, and the rows of `out` filled."""
    count = 0
    n = ts.size
    k = np.searchsorted(fix_row, first)
    ox, oy, bx, by, bz = r["offset"][0], r["offset"][1], r["base"][0], r["base"][1], r["base"][2]
    rx, ry, rz = r["rest"][0], r["rest"][1], r["rest"][2]
    ux, uy, sx, sy = r["smooth"][0], r["smooth"][1], r["smooth"][2], r["smooth"][3]
    tx, ty, low, high, variance = r["tilt"][0], r["tilt"][1], r["low"], r["high"], r["variance"]
    last, step, interval, handled = r["t"], r["step"], r["interval"], r["handled"]
    gx, gy, reference_end = r["reference"][0], r["reference"][1], r["reference_end"]
    lean_x, lean_y = 1.0 + GRAVITY * p["pitch_per_acceleration"], 1.0 + GRAVITY * p["roll_per_acceleration"]
    known, unknown, base, rest, smooth, tilting, fall, rise, road, pace = _shares(p, step)
    tilt2, plan2, pulse2 = p["handled_tilt"] ** 2, p["handled_plan"] ** 2, p["pulse_level"] ** 2
    pothole2, ratio2 = p["pothole"] ** 2, p["pothole_ratio"] ** 2
    phase, base_clip, harsh_clip = r["phase"], p["base_clip"], p["harsh_clip"]
    unlean_x, unlean_y = 1.0 / lean_x, 1.0 / lean_y
    i = first
    while i < n and count + 6 < out.shape[0]:
        t = ts[i]
        if k < fix_row.size and fix_row[k] == i:
            _take_fix(p, r, t, fix_valid[k], fix[k])
            gx, gy, reference_end = r["reference"][0], r["reference"][1], r["reference_end"]
            k += 1
        dt = t - last
        if dt <= 0.0:
            i += 1
            continue
        f0, f1, f2 = fs[i, 0], fs[i, 1], fs[i, 2]
        x = turn[0, 0] * f0 + turn[0, 1] * f1 + turn[0, 2] * f2
        y = turn[1, 0] * f0 + turn[1, 1] * f1 + turn[1, 2] * f2
        z = turn[2, 0] * f0 + turn[2, 1] * f1 + turn[2, 2] * f2 - GRAVITY
        if not dt <= p["max_gap"]:
            count = _break_off(p, r, handled, interval, out, count)
            bx = by = bz = rx = ry = rz = ux = uy = sx = sy = tx = ty = high = 0.0
            low, last, handled, r["session_start"], phase = z, t, -math.inf, t, r["phase"]
            i += 1
            continue
        last = t
        if abs(dt - step) > 1e-6:
            step = dt
            known, unknown, base, rest, smooth, tilting, fall, rise, road, pace = _shares(p, step)
        interval += pace * (dt - interval)
        # gravity, road and bias: what the receiver's acceleration does not explain, slowly
        if t <= reference_end:
            ox += known * _clip(x - lean_x * gx - ox, p["offset_clip"])
            oy += known * _clip(y - lean_y * gy - oy, p["offset_clip"])
        else:
            ox += unknown * _clip(x - ox, p["offset_clip"])
            oy += unknown * _clip(y - oy, p["offset_clip"])
        ax, ay = x - ox, y - oy
        # is the device in its place? a turn out of the vehicle's attitude says no
        w0, w1, w2 = ws[i, 0], ws[i, 1], ws[i, 2]
        if not math.isnan(w0 + w1 + w2):
            tx += (turn[0, 0] * w0 + turn[0, 1] * w1 + turn[0, 2] * w2) * dt - tilting * tx
            ty += (turn[1, 0] * w0 + turn[1, 1] * w1 + turn[1, 2] * w2) * dt - tilting * ty
        ex, ey, ez = ax - bx, ay - by, z - bz
        if phase != PULSE:
            rx += rest * (_clip(ax, base_clip) - rx)
            ry += rest * (_clip(ay, base_clip) - ry)
            rz += rest * (_clip(z, base_clip) - rz)
            bx += base * _clip(ex, base_clip)
            by += base * _clip(ey, base_clip)
            bz += base * _clip(ez, base_clip)
        if tx * tx + ty * ty > tilt2 or abs(rz) > p["handled_up"] or rx * rx + ry * ry > plan2:
            handled = t + p["handled_time"]
        # impacts
        if phase != IDLE or ex * ex + ey * ey > pulse2:
            count = _pulse(p, r, turn, t, dt, ax, ay, ex, ey, z - bz, f0, f1, f2, handled, interval, out, count)
            phase = r["phase"]
        # harsh driving
        ux += smooth * (_clip(ax * unlean_x, harsh_clip) - ux)
        uy += smooth * (_clip(ay * unlean_y, harsh_clip) - uy)
        sx += smooth * (ux - sx)
        sy += smooth * (uy - sy)
        if r["harsh_on"][0] or sx < -p["harsh_braking"]:
            count = _harsh(p, r, BRAKING, p["harsh_braking"], -sx, t, dt, sx, sy, handled, out, count)
        if r["harsh_on"][1] or sx > p["harsh_acceleration"]:
            count = _harsh(p, r, ACCELERATION, p["harsh_acceleration"], sx, t, dt, sx, sy, handled, out, count)
        if r["harsh_on"][2] or abs(sy) > p["harsh_cornering"]:
            count = _harsh(p, r, CORNERING, p["harsh_cornering"], abs(sy), t, dt, sx, sy, handled, out, count)
        # potholes
        low += fall * (z - low)
        high += rise * (z - low - high)
        power = high * high
        if r["pothole_on"] or (power > pothole2 and power > ratio2 * variance):
            count = _pothole(p, r, t, high, handled, interval, out, count)
        variance += road * (min(power, pothole2) - variance)
        i += 1
    if i == n and count < out.shape[0]:
        count = _tell_at_once(p, r, handled, interval, out, count)
    r["offset"][0], r["offset"][1], r["base"][0], r["base"][1], r["base"][2] = ox, oy, bx, by, bz
    r["rest"][0], r["rest"][1], r["rest"][2] = rx, ry, rz
    r["smooth"][0], r["smooth"][1], r["smooth"][2], r["smooth"][3] = ux, uy, sx, sy
    r["tilt"][0], r["tilt"][1], r["low"], r["high"], r["variance"] = tx, ty, low, high, variance
    r["t"], r["step"], r["interval"], r["handled"] = last, step, interval, handled
    return i, count


@njit(cache=True, nogil=True)
def _clip(value, limit):
    return min(max(value, -limit), limit)


@njit(cache=True, nogil=True)
def _shares(p, dt):
    """Give the share of the way each first-order low-pass goes in `dt` s."""
    return (
        dt / (p["offset_time"] + dt),
        dt / (p["offset_time_without_fixes"] + dt),
        dt / (p["base_time"] + dt),
        dt / (p["rest_time"] + dt),
        dt / (p["harsh_smoothing"] + dt),
        dt / (p["tilt_time"] + dt),
        dt / (1.0 / (2.0 * math.pi * p["pothole_low"]) + dt),
        dt / (1.0 / (2.0 * math.pi * p["pothole_high"]) + dt),
        dt / (p["road_time"] + dt),
        dt / (1.0 + dt),
    )


@njit(cache=True, nogil=True)
def _take_fix(p, r, t, valid, fix):
    """Take speed and acceleration from a fix and the one before."""
    speed, course = fix[SPEED], fix[COURSE]
    if not valid or not math.isfinite(speed):
        return
    since = t - r["fix_t"]
    if since <= 0.0:
        return
    if since <= p["max_fix_age"]:
        r["reference"][0] = (speed - r["fix_speed"]) / since
        turned = (course - r["fix_course"] + math.pi) % (2.0 * math.pi) - math.pi
        slow = min(speed, r["fix_speed"]) < p["course_speed"] or not math.isfinite(turned)
        r["reference"][1] = 0.0 if slow else -0.5 * (speed + r["fix_speed"]) * turned / since
        r["reference_end"] = t + p["max_fix_age"]
    r["fix_t"], r["fix_speed"], r["fix_course"] = t, speed, course


@njit(cache=True, nogil=True)
def _speed(p, r, t):
    return r["fix_speed"] if t - r["fix_t"] <= p["max_fix_age"] else math.nan


@njit(cache=True, nogil=True)
def _break_off(p, r, handled, interval, out, count):
    """Samples are missing: what was going on ended with them."""
    count = _tell_at_once(p, r, handled, interval, out, count)
    r["phase"] = IDLE
    r["harsh_on"][:] = 0
    r["pothole_on"] = 0
    r["quiet_end"] = r["pothole_end"] = -math.inf
    return count


@njit(cache=True, nogil=True)
def _pulse(p, r, turn, t, dt, ax, ay, ex, ey, ez, f0, f1, f2, handled, interval, out, count):
    """Follow a pulse on the plan from its first sample to the end of the time after it in which it may be dismissed."""
    total, size = math.sqrt(ax * ax + ay * ay), math.sqrt(ex * ex + ey * ey)
    least = min(total, size)  # tyres do neither
    if least > p["impact_level"] and t - r["pulse_end"] <= p["impact_back_time"]:
        _swing_back(r, ex, ey)
    if r["phase"] == AFTER:
        if handled > t and not r["told"]:
            r["phase"] = IDLE
        elif t - r["pulse_end"] > p["impact_wait"]:
            if r["told"] or _is_impact(p, r, handled, interval):
                r["quiet_end"] = t + p["impact_refractory"]
            count = _tell_at_once(p, r, handled, interval, out, count)
            r["phase"] = IDLE
        return count
    if r["phase"] == IDLE:
        if t < r["quiet_end"] or handled > t:
            return count
        _begin_pulse(p, r, t, dt)
    _gather(r, turn, dt, ax, ay, ex, ey, ez, f0, f1, f2)
    if least > p["impact_level"]:
        r["push"][0] += ex * dt
        r["push"][1] += ey * dt
        r["path"] += size * dt
    if size > r["excess"]:
        r["excess"], r["peak_t"] = size, t
    r["peak"] = max(r["peak"], total)
    if least > min(max(p["pulse_level"], p["pulse_end_share"] * r["excess"]), p["impact_level"]):
        r["pulse_end"] = t
    if t - r["pulse_end"] > p["pulse_pause"] or t - r["peak_t"] > p["pulse_longest"]:
        r["phase"] = AFTER if r["told"] or _is_impact(p, r, handled, interval) else IDLE
    return count


@njit(cache=True, nogil=True)
def _swing_back(r, ex, ey):
    """Keep the largest acceleration against the push so far: what rings swings back, what was hit does not."""
    push = math.hypot(r["push"][0], r["push"][1])
    if push > 0.0:
        r["back"] = max(r["back"], -(ex * r["push"][0] + ey * r["push"][1]) / push)


@njit(cache=True, nogil=True)
def _begin_pulse(p, r, t, dt):
    r["phase"], r["told"] = PULSE, 0
    r["pulse_start"], r["pulse_end"], r["peak_t"] = t - dt, t, t
    r["pulse_speed"] = _speed(p, r, t)
    r["peak"] = r["excess"] = r["up"] = r["change_up"] = r["path"] = r["clipped"] = r["before_dt"] = r["range_end"] = (
        0.0
    )
    r["change"][:] = 0.0
    r["push"][:] = 0.0
    r["costs"][:] = 0.0
    r["before"][:] = 0.0


@njit(cache=True, nogil=True)
def _gather(r, turn, dt, ax, ay, ex, ey, ez, f0, f1, f2):
    """Add a sample to what is not asked for its size."""
    r["change"][0] += ax * dt
    r["change"][1] += ay * dt
    r["change_up"] += ez * dt
    r["up"] = max(r["up"], abs(ez))
    now = (f0, f1, f2)
    flat = (_is_flat(r, 0, f0), _is_flat(r, 1, f1), _is_flat(r, 2, f2))
    _compare(r, turn, flat)
    if max(abs(f0), abs(f1), abs(f2)) > (1.0 + FLAT) * r["range_end"]:
        r["range_end"] = 0.0
    for i in range(3):
        r["before_flat"][i] = flat[i] or (r["range_end"] > 0.0 and abs(now[i]) >= (1.0 - FLAT) * r["range_end"])
        r["before"][i] = now[i]
        r["before_excess"][i] = turn[0, i] * ex + turn[1, i] * ey + turn[2, i] * ez
    r["before_dt"] = dt


@njit(cache=True, nogil=True)
def _is_flat(r, axis, value):
    """Whether an axis repeats itself as it does at the end of its range, which is learnt so."""
    if abs(value) < FLAT_LEAST or abs(value - r["before"][axis]) > FLAT * abs(value):
        return False
    r["range_end"] = max(r["range_end"], abs(value))
    return True


@njit(cache=True, nogil=True)
def _compare(r, turn, flat):
    """Ask of each direction how far the sample before is from a push along it; an axis at the end of its range may
    have been pushed further.
    """
    h, active = r["before_excess"], r["active"]
    any_flat = False
    for i in range(3):
        r["before_flat"][i] = r["before_flat"][i] or flat[i]
        any_flat = any_flat or r["before_flat"][i]
    if any_flat:
        r["clipped"] += r["before_dt"]
    for j in range(COURSES):
        d = (
            turn[0, 0] * COURSES_X[j] + turn[1, 0] * COURSES_Y[j],
            turn[0, 1] * COURSES_X[j] + turn[1, 1] * COURSES_Y[j],
            turn[0, 2] * COURSES_X[j] + turn[1, 2] * COURSES_Y[j],
        )
        active[:] = 1
        push = 0.0
        for _ in range(3 if any_flat else 1):
            along = square = 0.0
            for i in range(3):
                if active[i]:
                    along += d[i] * h[i]
                    square += d[i] * d[i]
            if square > 1e-6:
                push = max(along / square, 0.0)
            for i in range(3):
                active[i] = not (r["before_flat"][i] and (push * d[i] - h[i]) * r["before"][i] >= 0.0)
        for i in range(3):
            if active[i]:
                r["costs"][j] += (push * d[i] - h[i]) ** 2 * r["before_dt"]


@njit(cache=True, nogil=True)
def _best_course(costs):
    """Direction of the smallest cost, by a parabola through its neighbours."""
    j = np.argmin(costs)
    left, middle, right = costs[j - 1], costs[j], costs[(j + 1) % COURSES]
    bend = left - 2.0 * middle + right
    shift = 0.5 * (left - right) / bend if bend > 0.0 else 0.0
    return 2.0 * math.pi * (j + shift) / COURSES


@njit(cache=True, nogil=True)
def _is_impact(p, r, handled, interval):
    push = math.hypot(r["push"][0], r["push"][1])
    return (
        interval <= 1.0 / p["impact_rate"]
        and r["excess"] >= p["impact_peak"]
        and push >= p["impact_velocity"]
        and push >= p["impact_shortest"] * r["excess"]
        and push >= p["impact_one_way"] * r["path"]
        and (r["clipped"] >= p["impact_shortest"] or r["up"] <= p["impact_up"] * r["excess"])
        and (r["clipped"] >= p["impact_shortest"] or abs(r["change_up"]) <= p["impact_up_velocity"] * push)
        and (r["excess"] > p["impact_sure"] or r["back"] <= p["impact_back"] * r["excess"])
        and not handled > r["pulse_start"]
    )


@njit(cache=True, nogil=True)
def _tell_impact(r, end, out, count):
    course = _best_course(r["costs"]) if r["clipped"] > 0.0 else math.atan2(r["push"][1], r["push"][0])
    direction = (course + 2.0 * math.pi) % (2.0 * math.pi) - math.pi
    r["told"] = 1
    return _tell(
        out,
        count,
        IMPACT,
        r["peak_t"],
        r["pulse_start"],
        end,
        r["peak"],
        direction,
        r["change"][0],
        r["change"][1],
        r["pulse_speed"],
    )


@njit(cache=True, nogil=True)
def _tell(out, count, kind, t, start, end, peak, direction, forward, left, speed):
    row = out[count]
    row[0], row[1], row[2], row[3], row[4] = kind, t, start, end - start, peak
    row[5], row[6], row[7], row[8] = direction, forward, left, speed
    return count + 1


@njit(cache=True, nogil=True)
def _tell_at_once(p, r, handled, interval, out, count):
    """An impact that goes on at the end of the samples: there may be no more of them."""
    if r["phase"] == IDLE or r["told"] or not _is_impact(p, r, handled, interval):
        return count
    return _tell_impact(r, r["pulse_end"], out, count)


@njit(cache=True, nogil=True)
def _in_impact(p, r, start):
    """Whether what began at `start` is part of an impact: the jolt of it, or the slide after it."""
    since = r["quiet_end"] - start
    return r["phase"] == AFTER or 0.0 <= since <= p["impact_wait"] + p["impact_refractory"] + 1.0


@njit(cache=True, nogil=True)
def _harsh(p, r, kind, threshold, size, t, dt, sx, sy, handled, out, count):
    """Follow a manoeuvre from the threshold up to the lower one down; times are those before the low-pass."""
    h = kind - BRAKING
    lag = 2.0 * p["harsh_smoothing"]
    if not r["harsh_on"][h]:
        r["harsh_on"][h] = 1
        r["harsh_start"][h] = t - dt
        r["harsh_peak"][h] = 0.0
        r["harsh_speed"][h] = _speed(p, r, t)
        r["harsh_change"][h, 0] = r["harsh_change"][h, 1] = 0.0
    r["harsh_change"][h, 0] += sx * dt
    r["harsh_change"][h, 1] += sy * dt
    if size > r["harsh_peak"][h]:
        r["harsh_peak"][h], r["harsh_peak_t"][h] = size, t - lag
        r["harsh_direction"][h] = math.atan2(-sy, -sx)
    if size > p["harsh_end_share"] * threshold:
        return count
    r["harsh_on"][h] = 0
    start = r["harsh_start"][h] - lag
    now = _speed(p, r, t)
    standing = r["harsh_speed"][h] < p["moving_speed"] and now < p["moving_speed"]
    early = r["harsh_start"][h] < r["session_start"] + p["harsh_settling"]
    if (
        early
        or t - lag - start < p["harsh_least"]
        or handled > r["harsh_start"][h]
        or standing
        or _in_impact(p, r, start)
    ):
        return count
    return _tell(
        out, count, kind, r["harsh_peak_t"][h], start, t - lag, r["harsh_peak"][h], r["harsh_direction"][h],
        r["harsh_change"][h, 0], r["harsh_change"][h, 1], r["harsh_speed"][h],
    )  # fmt: skip


@njit(cache=True, nogil=True)
def _pothole(p, r, t, high, handled, interval, out, count):
    """Follow a jolt along the vertical until it has been quiet for the refractory time."""
    if not r["pothole_on"]:
        speed = _speed(p, r, t)
        if speed < p["moving_speed"] or handled > t or interval > 1.0 / p["impact_rate"] or r["phase"] != IDLE:
            return count
        r["pothole_on"] = 1
        r["pothole_start"] = r["pothole_end"] = t
        r["pothole_speed"], r["pothole_peak"] = speed, 0.0
    if abs(high) > r["pothole_peak"]:
        r["pothole_peak"], r["pothole_t"] = abs(high), t
    if abs(high) > 0.5 * p["pothole"]:
        r["pothole_end"] = t
    if t - r["pothole_end"] < p["pothole_refractory"] and t - r["pothole_start"] < p["pothole_longest"]:
        return count
    r["pothole_on"] = 0
    if handled > r["pothole_start"] or _in_impact(p, r, r["pothole_start"]):
        return count
    return _tell(
        out, count, POTHOLE, r["pothole_t"], r["pothole_start"], r["pothole_end"], r["pothole_peak"],
        math.nan, 0.0, 0.0, r["pothole_speed"],
    )  # fmt: skip
