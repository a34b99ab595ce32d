"""Every numba function of the attitude filters; imports nothing of the project: numba's cache watches one file.

`p` parameters and `s` state are records (`params`, `STATE`). Between two corrections the attitude follows the
gyroscope, and so do the averages of what accelerometer and magnetometer read: kept in the sensor's axes, they are
turned along with it. A filter is what happens at a correction, and for the linear one also between them.

Letters: f specific force, m magnetic field, q attitude q_ns, d a direction in local level axes, S innovation variance.
"""

import math

import numpy as np
from numba import njit

GRAVITY = 9.80665
"""m/s2, standard gravity"""
MOST_FORCE, MOST_FIELD, MOST_RATE = 1e4, 1e5, 1e3
"""m/s2, uT, rad/s; more is no reading"""
LEAST = 1e-12
"""squares of lengths below count as none"""
MOST_LINEAR = 0.2
"""rad, heading error up to which a tilt's share in it is believed"""
SEA_LEVEL_PRESSURE, SCALE_HEIGHT, LAPSE_EXPONENT = 101325.0, 44330.77, 0.190263
"""Pa, m, -: ICAO standard atmosphere below 11 km"""

GYRO, LINEAR, EKF, MADGWICK, QUEST_EKF = range(5)
"""The filters."""

SCRATCH = (20, 7)
"""Shape of the memory for what is in between."""

STATE = np.dtype(
    (
        np.record,  # so that the kernel runs uncompiled too
        [
            ("t", "f8"),  # s of the last sample, nan before the first
            ("started", "?"),  # whether there is an attitude
            ("compass", "?"),  # whether heading is that of the magnetic field
            ("settling", "?"),  # whether it was shaken ever since, so that averages tell more than the filter knows
            ("age", "f8"),  # s since the attitude was found
            ("rate_age", "f8"),  # s since the last reading of the gyroscope
            ("pending", "f8"),  # s since the last correction
            ("q", "f8", (4,)),  # q_ns
            ("turned", "f8", (4,)),  # rotation since the last correction
            ("angles", "f8", (3,)),  # rad, roll, pitch, yaw of the linear filter
            ("rate", "f8", (3,)),  # rad/s, last reading of the gyroscope
            ("filtered_rate", "f8", (3,)),  # rad/s, state of (64), bias taken out
            ("rate_variance", "f8"),  # (rad/s)^2 of the same
            ("bias", "f8", (3,)),  # rad/s
            ("covariance", "f8", (7, 7)),  # of quaternion and bias; linear: of roll, pitch and their biases
            ("force", "f8", (3,)),  # m/s2, first average
            ("mean_force", "f8", (3,)),  # m/s2, average of the average
            ("spread", "f8"),  # (m/s2)^2, mean square of the readings about their average
            ("field", "f8", (3,)),  # uT, average of the readings that were trusted
            ("field_now", "f8", (3,)),  # uT, average over a moment of all readings
            ("field_weight", "f8"),  # s, how long readings were averaged
            ("field_strength", "f8"),  # uT, of the undisturbed field; 0 = not known
            ("field_dip", "f8"),  # sine of its angle below the horizontal
            ("field_trust", "f8"),  # s since a reading of the magnetometer was not trusted
            ("field_doubt", "f8"),  # s for which no reading has been trusted
            ("sigma", "f8", (3,)),  # rad, of the rotation about east, north, up; nan where the filter has none
            ("altitude", "f8"),  # m, nan before the first pressure
        ],
    )
)

# --- vectors and quaternions


@njit(cache=True, nogil=True)
def dot(a, b):
    """Scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True)
def product(q, p, out):
    """Hamilton product q p (003 eq. 11)."""
    w = q[0] * p[0] - q[1] * p[1] - q[2] * p[2] - q[3] * p[3]
    x = q[0] * p[1] + q[1] * p[0] + q[2] * p[3] - q[3] * p[2]
    y = q[0] * p[2] - q[1] * p[3] + q[2] * p[0] + q[3] * p[1]
    z = q[0] * p[3] + q[1] * p[2] - q[2] * p[1] + q[3] * p[0]
    out[0], out[1], out[2], out[3] = w, x, y, z


@njit(cache=True, nogil=True)
def normalise(q):
    """Scale a quaternion to unit length."""
    scale = 1.0 / math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for i in range(4):
        q[i] *= scale


@njit(cache=True, nogil=True)
def into_level(q, v, out):
    """Give R(q) v: from sensor axes to local level axes."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    a, b, c = v[0], v[1], v[2]
    out[0] = (1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c
    out[1] = 2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z - w * x) * c
    out[2] = 2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c


@njit(cache=True, nogil=True)
def into_sensor(q, d, out):
    """Give R(q)' d: from local level axes to sensor axes (001 eq. 6.18, 003 eq. 29)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    a, b, c = d[0], d[1], d[2]
    out[0] = (1 - 2 * (y * y + z * z)) * a + 2 * (x * y + w * z) * b + 2 * (x * z - w * y) * c
    out[1] = 2 * (x * y - w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z + w * x) * c
    out[2] = 2 * (x * z + w * y) * a + 2 * (y * z - w * x) * b + (1 - 2 * (x * x + y * y)) * c


@njit(cache=True, nogil=True)
def rotation(x, y, z, out):
    """Quaternion of a rotation vector."""
    square = x * x + y * y + z * z
    if square < 1e-8:  # the next term of the series is below the last digit
        half = 0.5 - square / 48.0
        out[0] = 1.0 - square / 8.0
    else:
        angle = math.sqrt(square)
        half = math.sin(0.5 * angle) / angle
        out[0] = math.cos(0.5 * angle)
    out[1], out[2], out[3] = half * x, half * y, half * z


@njit(cache=True, nogil=True)
def from_angles(roll, pitch, yaw, out):
    """Quaternion of R = Rz(yaw) Ry(pitch) Rx(roll)."""
    cr, sr = math.cos(0.5 * roll), math.sin(0.5 * roll)
    cp, sp = math.cos(0.5 * pitch), math.sin(0.5 * pitch)
    cy, sy = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    out[0] = cy * cp * cr + sy * sp * sr
    out[1] = cy * cp * sr - sy * sp * cr
    out[2] = cy * sp * cr + sy * cp * sr
    out[3] = sy * cp * cr - cy * sp * sr


@njit(cache=True, nogil=True)
def wrap(angle):
    """Give the angle in [-pi, pi)."""
    return angle - 2 * math.pi * math.floor((angle + math.pi) / (2 * math.pi))


# --- what is common to all filters: clock, start, averages


@njit(cache=True, nogil=True)
def is_reading(v, most):
    """Tell whether a vector is a finite reading that is not zero and not more than `most`."""
    square = dot(v, v)
    return LEAST < square < most * most


@njit(cache=True, nogil=True)
def run(method, p, s, scratch, t, f, w, m, pressure, q_out, bias_out, altitude_out, sigma_out, trusted_out):
    """Take the state `s` through the samples. `m` and `pressure` may have no rows: no such sensor."""
    has_field, has_pressure = m.shape[0] > 0, pressure.shape[0] > 0
    for k in range(t.shape[0]):
        dt = t[k] - s.t if s.t == s.t else 0.0
        s.t = t[k]
        if s.started:
            take_rate(p, s, w[k], dt)
        if not s.started:
            take_rate(p, s, w[k], 0.0)
            if has_field:
                start(method, p, s, f[k], m[k], scratch)
            else:
                start(method, p, s, f[k], scratch[7], scratch)
        elif dt > 0.0:
            s.age += dt
            s.pending += dt
            turn(method, p, s, dt, scratch)
            average_force(p, s, f[k], dt)
            if has_field:
                average_field(method, p, s, m[k], dt)
            if s.pending >= p.correction_period:
                correct(method, p, s, scratch)
        if has_pressure:
            average_pressure(p, s, pressure[k], dt)
        q_out[k], bias_out[k], sigma_out[k] = s.q, s.bias, s.sigma
        altitude_out[k] = s.altitude
        trusted_out[k] = s.field_trust >= p.field_calm


@njit(cache=True, nogil=True)
def take_rate(p, s, w, dt):
    """Keep the reading of the gyroscope; when none has come for long, the attitude has to be found anew."""
    s.rate_age += dt
    if dot(w, w) < MOST_RATE * MOST_RATE:
        s.started = s.started and s.rate_age <= p.longest_gap
        s.rate_age = 0.0
        s.rate[0], s.rate[1], s.rate[2] = w[0], w[1], w[2]
    elif s.rate_age > p.longest_gap:
        for i in range(3):
            s.rate[i] = s.bias[i]


@njit(cache=True, nogil=True)
def start(method, p, s, f, m, scratch):
    """Find the attitude from one reading of accelerometer and, if there is one, of the magnetometer."""
    size = math.sqrt(dot(f, f))
    if not p.least_force * GRAVITY < size < p.most_force * GRAVITY:
        return
    if is_reading(m, MOST_FIELD):
        s.field[:] = m
        s.field_now[:] = m
    s.force[:] = f
    s.mean_force[:] = f
    s.spread, s.age, s.pending, s.settling = 0.0, 0.0, 0.0, True
    s.turned[0], s.turned[1], s.turned[2], s.turned[3] = 1.0, 0.0, 0.0, 0.0
    place(method, p, s, m, scratch)
    s.started = True


@njit(cache=True, nogil=True)
def place(method, p, s, m, scratch):
    """Put the attitude where the averaged force and the field, if it is a reading, say, whatever it was before."""
    level, north, f = scratch[0], scratch[1], s.mean_force
    roll, pitch = math.atan2(f[1], f[2]), math.atan2(-f[0], math.hypot(f[1], f[2]))
    yaw = s.angles[2]  # after a gap that of before
    if is_reading(m, MOST_FIELD):
        from_angles(roll, pitch, 0.0, level)
        into_level(level, m, north)
        if math.hypot(north[0], north[1]) > p.least_horizontal * math.sqrt(dot(m, m)):
            yaw = math.atan2(north[0], north[1])
            s.compass = True
            if s.field_strength == 0.0:
                s.field_strength = math.sqrt(dot(m, m))
                s.field_dip = -dot(m, f) / (s.field_strength * math.sqrt(dot(f, f)))
                s.field_weight = 0.0
    from_angles(roll, pitch, yaw, s.q)
    s.angles[0], s.angles[1], s.angles[2] = roll, pitch, yaw
    start_covariance(method, p, s)


@njit(cache=True, nogil=True)
def start_covariance(method, p, s):
    """Covariance of a first attitude; that of the bias is kept when there has been one."""
    cov = s.covariance
    known = cov[4, 4] > 0.0
    for i in range(7):
        for j in range(7):
            if i < 4 or j < 4 or not known:
                cov[i, j] = 0.0
    if method in (LINEAR, MADGWICK):
        cov[0, 0] = cov[1, 1] = p.start_tilt * p.start_tilt
        cov[2, 2] = p.start_heading * p.start_heading
    else:
        add_variance(s, 0, p.start_tilt)
        add_variance(s, 1, p.start_tilt)
        add_variance(s, 2, p.start_heading)
    if method in (EKF, QUEST_EKF):
        finish(s)
    if not known:
        for i in range(4, 7):
            cov[i, i] = p.start_bias * p.start_bias


@njit(cache=True, nogil=True)
def add_variance(s, axis, sigma):
    """Make a rotation about east, north or up less sure."""
    u = level_axis(s.q, axis)
    for i in range(4):
        for j in range(4):
            s.covariance[i, j] += 0.25 * sigma * sigma * u[i] * u[j]


@njit(cache=True, nogil=True)
def level_axis(q, axis):
    """Give e q for the unit vector e of east, north or up: twice its rate is that of a rotation about e."""
    if axis == 0:
        return -q[1], q[0], -q[3], q[2]
    if axis == 1:
        return -q[2], q[3], q[0], -q[1]
    return -q[3], -q[2], q[1], q[0]


@njit(cache=True, nogil=True)
def turn(method, p, s, dt, scratch):
    """Turn the attitude by what the gyroscope read, and the averages with the sensor."""
    delta, rate = scratch[0], scratch[1]
    for i in range(3):
        rate[i] = s.rate[i] - s.bias[i]
    if method == QUEST_EKF:
        filter_rate(p, s, rate, dt)
        for i in range(3):
            rate[i] = s.filtered_rate[i]
    rotation(rate[0] * dt, rate[1] * dt, rate[2] * dt, delta)
    product(s.turned, delta, s.turned)
    if method == LINEAR:
        turn_linear(p, s, rate, dt)
    else:
        product(s.q, delta, s.q)
        normalise(s.q)
    into_sensor(delta, s.force, s.force)
    into_sensor(delta, s.mean_force, s.mean_force)
    into_sensor(delta, s.field, s.field)
    into_sensor(delta, s.field_now, s.field_now)


@njit(cache=True, nogil=True)
def average_force(p, s, f, dt):
    """Average the specific force twice over `force_time`, faster while there is little to average."""
    if not dot(f, f) < MOST_FORCE * MOST_FORCE:
        return
    time = s.age if s.settling and s.spread > p.settle_spread**2 else min(p.force_time, s.age)
    gain = dt / (time + dt)
    square = 0.0
    for i in range(3):
        change = f[i] - s.force[i]
        square += change * change
        s.force[i] += gain * change
        s.mean_force[i] += gain * (s.force[i] - s.mean_force[i])
    time = p.spread_rise if square > s.spread else p.spread_time  # shaking is believed at once, calm only after a while
    s.spread += dt / (min(time, s.age) + dt) * (square - s.spread)


@njit(cache=True, nogil=True)
def average_field(method, p, s, m, dt):
    """Average the magnetic field over `field_time` where its strength and dip are those of the Earth."""
    if not is_reading(m, MOST_FIELD):
        s.field_trust = 0.0
        return
    gain = dt / (p.field_moment + dt)
    for i in range(3):
        s.field_now[i] += gain * (m[i] - s.field_now[i])
    force = math.sqrt(dot(s.mean_force, s.mean_force))
    strength = math.sqrt(dot(s.field_now, s.field_now))
    if not (force > p.least_force * GRAVITY and strength > 0.0):
        s.field_trust = 0.0
        return
    dip = -dot(s.field_now, s.mean_force) / (strength * force)
    if s.field_strength == 0.0 or s.age < p.reference_start:
        s.field_strength, s.field_dip = strength, dip
        s.field_trust += dt
    elif (
        abs(strength - s.field_strength) < p.field_tolerance * s.field_strength
        and abs(dip - s.field_dip) < p.dip_tolerance
    ):
        s.field_trust += dt
        s.field_doubt = 0.0
    else:
        s.field_trust = 0.0
        s.field_doubt += dt
        if s.field_doubt > p.field_patience:
            adopt_field(method, p, s, strength, dip)
    if s.field_trust >= p.field_calm and 1.0 - dip * dip > p.least_horizontal * p.least_horizontal:
        s.compass = True
        s.field_weight += dt
        gain = dt / (min(p.field_time, s.field_weight) + dt)
        for i in range(3):
            s.field[i] += gain * (m[i] - s.field[i])
        gain = dt / (min(p.reference_time, s.field_weight) + dt)
        s.field_strength += gain * (strength - s.field_strength)
        s.field_dip += gain * (dip - s.field_dip)


@njit(cache=True, nogil=True)
def adopt_field(method, p, s, strength, dip):
    """Take the field that is there for the Earth's; the heading may be any then."""
    s.field_strength, s.field_dip = strength, dip
    s.field_doubt, s.field_trust, s.field_weight = 0.0, 0.0, 0.0
    s.field[:] = s.field_now
    if method == MADGWICK:
        s.covariance[2, 2] += p.start_heading * p.start_heading
    elif method in (EKF, QUEST_EKF):
        add_variance(s, 2, p.start_heading)
        finish(s)


@njit(cache=True, nogil=True)
def average_pressure(p, s, pressure, dt):
    """Altitude in the standard atmosphere, smoothed over `altitude_time`."""
    if not 1e3 < pressure < 2e5:
        return
    altitude = SCALE_HEIGHT * (1.0 - (pressure / SEA_LEVEL_PRESSURE) ** LAPSE_EXPONENT)
    if s.altitude == s.altitude:
        s.altitude += dt / (p.altitude_time + dt) * (altitude - s.altitude)
    else:
        s.altitude = altitude


# --- corrections


@njit(cache=True, nogil=True)
def correct(method, p, s, scratch):
    """Let a filter correct the attitude and the bias of the gyroscope by what the averages say."""
    force = math.sqrt(dot(s.mean_force, s.mean_force))
    usable = p.least_force * GRAVITY < force < p.most_force * GRAVITY
    seen = s.field_trust >= p.field_calm and s.field_weight > 0.0
    shaken = s.spread > p.settle_spread * p.settle_spread
    s.settling = s.settling and s.age < p.settle_time and (shaken or s.age < p.settle_look)
    if usable and shaken and s.settling and method != GYRO:
        place(method, p, s, s.field_now, scratch)
    elif method == LINEAR:
        linear(p, s, scratch, force, usable)
    elif method == EKF:
        predict(p, s, scratch)
        ekf(p, s, scratch, force, usable, seen)
    elif method == QUEST_EKF:
        predict(p, s, scratch)
        quest_ekf(p, s, scratch, force, usable, seen)
    elif method == MADGWICK:
        madgwick(p, s, scratch, force, usable, seen)
    for i in range(3):
        s.bias[i] = min(max(s.bias[i], -p.most_bias), p.most_bias)
    s.turned[0], s.turned[1], s.turned[2], s.turned[3] = 1.0, 0.0, 0.0, 0.0
    s.pending = 0.0
    if method != LINEAR:
        s.angles[2] = math.atan2(2 * (s.q[0] * s.q[3] + s.q[1] * s.q[2]), 1 - 2 * (s.q[2] * s.q[2] + s.q[3] * s.q[3]))


@njit(cache=True, nogil=True)
def tilt_variance(p, s, force):
    """Variance (rad^2) of the direction of the averaged specific force, as one of many that say nearly the same."""
    excess = force / GRAVITY - 1.0
    shaking = s.spread / (GRAVITY * GRAVITY)
    density = p.tilt_noise**2 + p.shake_noise**2 * shaking + p.excess_noise**2 * excess * excess
    return density / s.pending


@njit(cache=True, nogil=True)
def doubted(p, variance, square, own):
    """Variance of a measurement by its likelihood (001 eq. 6.5): one beyond the gate has what puts it there.

    `square` is that of the innovation; what the state's `own` variance may explain is not held against it.
    """
    return max(variance, (square - p.own_gate * own) / p.gate)


@njit(cache=True, nogil=True)
def update(s, h, innovation, variance, scratch):
    """Take in a scalar measurement h x (001 eq. 6.4-6.8)."""
    cov, gain = s.covariance, scratch[6]
    S = variance
    for i in range(7):
        total = 0.0
        for j in range(7):
            total += cov[i, j] * h[j]
        gain[i] = total
        S += h[i] * total
    for i in range(4):
        s.q[i] += gain[i] / S * innovation
    for i in range(3):
        s.bias[i] += gain[4 + i] / S * innovation
    for i in range(7):
        scaled = gain[i] / S
        for j in range(7):
            cov[i, j] -= scaled * gain[j]


@njit(cache=True, nogil=True)
def predict(p, s, scratch):
    """Covariance of quaternion and bias over the rotation since the last correction (001 eq. 6.15-6.16, exact)."""
    cov, q, D, T = s.covariance, s.q, s.turned, s.pending
    M, G, A = scratch[8:12, 0:4], scratch[12:16, 0:3], scratch[16:20, 0:7]
    M[0, 0], M[0, 1], M[0, 2], M[0, 3] = D[0], -D[1], -D[2], -D[3]
    M[1, 0], M[1, 1], M[1, 2], M[1, 3] = D[1], D[0], D[3], -D[2]
    M[2, 0], M[2, 1], M[2, 2], M[2, 3] = D[2], -D[3], D[0], D[1]
    M[3, 0], M[3, 1], M[3, 2], M[3, 3] = D[3], D[2], -D[1], D[0]
    c = -0.5 * T
    G[0, 0], G[0, 1], G[0, 2] = -c * q[1], -c * q[2], -c * q[3]
    G[1, 0], G[1, 1], G[1, 2] = c * q[0], -c * q[3], c * q[2]
    G[2, 0], G[2, 1], G[2, 2] = c * q[3], c * q[0], -c * q[1]
    G[3, 0], G[3, 1], G[3, 2] = -c * q[2], c * q[1], c * q[0]
    for i in range(4):
        for j in range(7):
            total = 0.0
            for k in range(4):
                total += M[i, k] * cov[k, j]
            for k in range(3):
                total += G[i, k] * cov[4 + k, j]
            A[i, j] = total
    noise = p.rate_noise * p.rate_noise / T  # of (G w)(G w)'
    for i in range(4):
        for j in range(i + 1):
            total = 0.0
            for k in range(4):
                total += A[i, k] * M[j, k]
            for k in range(3):
                total += (A[i, 4 + k] + noise * G[i, k]) * G[j, k]
            cov[i, j] = total
            cov[j, i] = total
        for j in range(4, 7):
            cov[i, j] = A[i, j]
            cov[j, i] = A[i, j]
    walk(p, s)


@njit(cache=True, nogil=True)
def finish(s):
    """Normalise, and tell how sure the attitude is."""
    normalise(s.q)
    for axis in range(3):
        u = level_axis(s.q, axis)
        total = 0.0
        for i in range(4):
            for j in range(4):
                total += u[i] * s.covariance[i, j] * u[j]
        s.sigma[axis] = 2.0 * math.sqrt(max(total, 0.0))


@njit(cache=True, nogil=True)
def field_row(s, field, h):
    """Heading error that the averaged field tells of, and its Jacobian: all that (001 eq. 6.21) leaves of (6.22-6.24).

    What is left is the angle from north of the field's horizontal part. A tilt about north changes it too, which is
    told only where the angle is small: far from the goal it would throw the tilt about.
    """
    into_level(s.q, s.field, field)
    off = math.atan2(field[0], field[1])
    slope = field[2] / math.hypot(field[0], field[1]) if abs(off) < MOST_LINEAR else 0.0
    up, north = level_axis(s.q, 2), level_axis(s.q, 1)
    for i in range(4):
        h[i] = 2.0 * (up[i] - slope * north[i])
    h[4] = h[5] = h[6] = 0.0
    return off


@njit(cache=True, nogil=True)
def heading_variance(p, s):
    """Variance (rad^2) of the heading of the averaged field, as one of many that say nearly the same."""
    return p.field_noise * p.field_noise / ((1.0 - s.field_dip * s.field_dip) * s.pending)


# --- the filters


@njit(cache=True, nogil=True)
def gravity_row(q, row, h):
    """Predicted direction of the specific force (001 eq. 6.18) and its Jacobian (6.24), a row of both."""
    h[4] = h[5] = h[6] = 0.0
    if row == 0:
        h[0], h[1], h[2], h[3] = -2 * q[2], 2 * q[3], -2 * q[0], 2 * q[1]
        return 2 * (q[1] * q[3] - q[0] * q[2])
    if row == 1:
        h[0], h[1], h[2], h[3] = 2 * q[1], 2 * q[0], 2 * q[3], 2 * q[2]
        return 2 * (q[2] * q[3] + q[0] * q[1])
    h[0], h[1], h[2], h[3] = 2 * q[0], -2 * q[1], -2 * q[2], 2 * q[3]
    return q[0] * q[0] - q[1] * q[1] - q[2] * q[2] + q[3] * q[3]


@njit(cache=True, nogil=True)
def ekf(p, s, scratch, force, usable, seen):
    """Extended Kalman filter of 001 6.3: quaternion and gyroscope bias, a component of the measurement at a time."""
    h = scratch[5]
    if usable:
        square = 0.0
        for row in range(3):
            square += (s.mean_force[row] / force - gravity_row(s.q, row, h)) ** 2
        own = s.sigma[0] * s.sigma[0] + s.sigma[1] * s.sigma[1]
        variance = doubted(p, tilt_variance(p, s, force), square, own)
        for row in range(3):
            predicted = gravity_row(s.q, row, h)
            update(s, h, s.mean_force[row] / force - predicted, variance, scratch)
            normalise(s.q)
    if seen:
        innovation = field_row(s, scratch[0], h)
        variance = heading_variance(p, s)
        if abs(innovation) >= MOST_LINEAR:  # as much may come from a tilt
            variance += tilt_variance(p, s, force) * s.field_dip * s.field_dip / (1.0 - s.field_dip * s.field_dip)
        variance = doubted(p, variance, innovation * innovation, s.sigma[2] * s.sigma[2])
        update(s, h, innovation, variance, scratch)
    finish(s)


@njit(cache=True, nogil=True)
def filter_rate(p, s, rate, dt):
    """Rate of 003 eq. 64: noise behind a lag of `rate_lag`, measured by the gyroscope (66)."""
    kept = math.exp(-dt / p.rate_lag)
    variance = kept * kept * s.rate_variance + p.rate_motion * p.rate_motion * (1.0 - kept * kept)
    gain = variance / (variance + p.rate_noise * p.rate_noise / dt)
    s.rate_variance = (1.0 - gain) * variance
    for i in range(3):
        s.filtered_rate[i] = kept * s.filtered_rate[i] + gain * (rate[i] - kept * s.filtered_rate[i])


@njit(cache=True, nogil=True)
def quest_ekf(p, s, scratch, force, usable, seen):
    """Filter of 003 4.3.3: QUEST makes an attitude of the two averages, a Kalman filter takes it for a measurement."""
    if usable:
        h, measured, error = scratch[5], scratch[0], scratch[1]
        tilt, heading = tilt_variance(p, s, force), heading_variance(p, s)
        heading += tilt * s.field_dip * s.field_dip / (1.0 - s.field_dip * s.field_dip)  # a tilt turns the field aside
        if quest(p, s, scratch, force, seen, tilt, heading, measured):
            into_level(s.q, measured[1:4], error)  # the measured quaternion in the axes its noise is diagonal in
            own = s.sigma[0] * s.sigma[0] + s.sigma[1] * s.sigma[1]
            tilt = doubted(p, tilt, 4.0 * (error[0] * error[0] + error[1] * error[1]), own)
            heading = doubted(p, heading, 4.0 * error[2] * error[2], s.sigma[2] * s.sigma[2])
            for axis in range(3 if seen else 2):
                u = level_axis(s.q, axis)
                for i in range(4):
                    h[i] = 2.0 * u[i]
                h[4] = h[5] = h[6] = 0.0
                update(s, h, 2.0 * error[axis], heading if axis == 2 else tilt, scratch)
    finish(s)


@njit(cache=True, nogil=True)
def quest(p, s, scratch, force, seen, tilt, heading, out):
    """QUEST (Shuster & Oh 1981) for two vectors: the rotation from the attitude at hand to the measured one.

    Beginning with the attitude at hand is the sequential rotation that keeps it away from its singularity at 180 deg.
    """
    v1, v2, d, w2 = scratch[2], scratch[3], scratch[4], scratch[7]
    d[0], d[1], d[2] = 0.0, 0.0, 1.0
    into_sensor(s.q, d, v1)
    dip = s.field_dip if seen else 0.0
    d[0], d[1], d[2] = 0.0, math.sqrt(1.0 - dip * dip), -dip
    into_sensor(s.q, d, v2)
    along = 0.0 if seen else dot(v2, s.mean_force) / (force * force)
    for i in range(3):  # without a compass the heading is what it is: north as it is held for, level
        w2[i] = s.field[i] if seen else v2[i] - along * s.mean_force[i]
    size = math.sqrt(dot(w2, w2))
    if size * size < LEAST:
        return False
    for i in range(3):
        w2[i] /= size
    a1, a2 = heading / (tilt + heading), tilt / (tilt + heading)
    B, S = scratch[8:11, 0:3], scratch[12:15, 0:3]
    for i in range(3):
        for j in range(3):
            B[i, j] = a1 * s.mean_force[i] / force * v1[j] + a2 * w2[i] * v2[j]
    z0, z1, z2 = B[1, 2] - B[2, 1], B[2, 0] - B[0, 2], B[0, 1] - B[1, 0]
    for i in range(3):
        for j in range(3):
            S[i, j] = B[i, j] + B[j, i]
    trace = B[0, 0] + B[1, 1] + B[2, 2]
    cosine_w = dot(s.mean_force, w2) / force
    cosine_v = dot(v1, v2)
    sines = math.sqrt(max(1 - cosine_w * cosine_w, 0.0) * max(1 - cosine_v * cosine_v, 0.0))
    largest = math.sqrt(max(a1 * a1 + a2 * a2 + 2 * a1 * a2 * (cosine_w * cosine_v + sines), 0.0))
    kappa = (
        S[0, 0] * S[1, 1]
        - S[0, 1] * S[0, 1]
        + S[1, 1] * S[2, 2]
        - S[1, 2] * S[1, 2]
        + S[2, 2] * S[0, 0]
        - S[0, 2] * S[0, 2]
    )
    determinant = (
        S[0, 0] * (S[1, 1] * S[2, 2] - S[1, 2] * S[1, 2])
        - S[0, 1] * (S[0, 1] * S[2, 2] - S[1, 2] * S[0, 2])
        + S[0, 2] * (S[0, 1] * S[1, 2] - S[1, 1] * S[0, 2])
    )
    alpha = largest * largest - trace * trace + kappa
    beta = largest - trace
    gamma = alpha * (largest + trace) - determinant
    for i in range(3):
        once = S[i, 0] * z0 + S[i, 1] * z1 + S[i, 2] * z2
        d[i] = once
    for i in range(3):
        twice = S[i, 0] * d[0] + S[i, 1] * d[1] + S[i, 2] * d[2]
        z = z0 if i == 0 else (z1 if i == 1 else z2)
        out[1 + i] = alpha * z + beta * d[i] + twice
    out[0] = gamma
    length = math.sqrt(out[0] * out[0] + dot(out[1:4], out[1:4]))
    if length < LEAST:
        return False
    for i in range(4):
        out[i] /= length if gamma >= 0.0 else -length
    return True


@njit(cache=True, nogil=True)
def gradient(q, d, v, out):
    """Gradient J'f of half the square of f = R(q)' d - v (003 eq. 28-30), for unit vectors d and v."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    a, b, c = d[0], d[1], d[2]
    f0 = 2 * (a * (0.5 - y * y - z * z) + b * (w * z + x * y) + c * (x * z - w * y)) - v[0]
    f1 = 2 * (a * (x * y - w * z) + b * (0.5 - x * x - z * z) + c * (w * x + y * z)) - v[1]
    f2 = 2 * (a * (w * y + x * z) + b * (y * z - w * x) + c * (0.5 - x * x - y * y)) - v[2]
    out[0] = 2 * ((b * z - c * y) * f0 + (c * x - a * z) * f1 + (a * y - b * x) * f2)
    out[1] = 2 * ((b * y + c * z) * f0 + (a * y - 2 * b * x + c * w) * f1 + (a * z - b * w - 2 * c * x) * f2)
    out[2] = 2 * ((-2 * a * y + b * x - c * w) * f0 + (a * x + c * z) * f1 + (a * w + b * z - 2 * c * y) * f2)
    out[3] = 2 * ((-2 * a * z + b * w + c * x) * f0 + (-a * w - 2 * b * z + c * y) * f1 + (a * x + b * y) * f2)


@njit(cache=True, nogil=True)
def madgwick(p, s, scratch, force, usable, seen):
    """Filter of 003 4.2: a step down the gradient of each vector (46-48), its mean the gyroscope's bias (50-52).

    Near the goal the step is a share of the gradient: `gains` gives it, where (48) would tremble; far away it is no
    faster than `beta`. Of the field's gradient only the part about the vertical counts: a disturbed field shall not
    tilt.
    """
    error, step, gain, axes = scratch[0], scratch[1], scratch[6], scratch[8:11, 0:3]
    gradient_errors(s, scratch, force, usable, seen, error)
    for i in range(3):
        step[i] = 0.0
        for j in range(3):
            axes[i, j] = 1.0 if i == j else 0.0
        into_sensor(s.q, axes[i], axes[i])
    predict_angles(p, s, axes)
    for i in range(3):
        if not (usable if i < 2 else seen):
            continue
        if i < 2:
            variance, square = tilt_variance(p, s, force), error[0] * error[0] + error[1] * error[1]
        else:
            variance, square = heading_variance(p, s), error[2] * error[2]
            variance += (
                s.covariance[0, 0] * s.field_dip * s.field_dip / (1.0 - s.field_dip * s.field_dip)
            )  # as it turns
        measure_angle(p, s, i, variance, square, gain, scratch[5])
        innovation = error[i] - step[i]
        wanted, most = abs(gain[i] * innovation), p.beta * s.pending
        if wanted > most:
            innovation *= most / wanted
        for j in range(3):
            step[j] += gain[j] * innovation
            s.bias[j] -= gain[4 + j] * innovation
    rotation(-step[0], -step[1], -step[2], error)
    product(error, s.q, s.q)
    normalise(s.q)


@njit(cache=True, nogil=True)
def gradient_errors(s, scratch, force, usable, seen, error):
    """Rotations (rad) about east, north and up that the gradients of gravity and field point against; 0 = not seen."""
    d, v, downhill = scratch[3], scratch[4], scratch[5]
    error[0] = error[1] = error[2] = 0.0
    if usable:
        d[0], d[1], d[2] = 0.0, 0.0, 1.0
        for i in range(3):
            v[i] = s.mean_force[i] / force
        gradient(s.q, d, v, downhill)
        error[0], error[1] = 0.5 * about(s.q, downhill, 0), 0.5 * about(s.q, downhill, 1)
    if seen:
        into_level(s.q, s.field, v)
        size = math.sqrt(dot(s.field, s.field))
        horizontal = math.hypot(v[0], v[1]) / size
        d[0], d[1], d[2] = 0.0, horizontal, v[2] / size  # (49): a reference of the inclination that is measured
        for i in range(3):
            v[i] = s.field[i] / size
        gradient(s.q, d, v, downhill)
        error[2] = 0.5 * about(s.q, downhill, 2) / max(horizontal * horizontal, LEAST)


@njit(cache=True, nogil=True)
def predict_angles(p, s, axes):
    """Covariance of three angles and the bias over the time since the last correction (001 eq. 6.10).

    The rate of angle i is that of the gyroscope about the sensor axis `axes[i]`.
    """
    cov, T = s.covariance, s.pending
    for i in range(3):
        for j in range(3):
            cov[i, j] -= T * dot(axes[i], cov[j, 4:7])
    for i in range(3):
        for k in range(4, 7):
            cov[i, k] -= T * dot(axes[i], cov[k, 4:7])
    for i in range(3):
        for j in range(3):
            cov[i, j] -= T * dot(cov[i, 4:7], axes[j])
        for k in range(4, 7):
            cov[k, i] = cov[i, k]
        cov[i, i] += p.angle_noise * p.angle_noise * T
    walk(p, s)


@njit(cache=True, nogil=True)
def measure_angle(p, s, i, variance, square, gain, own):
    """Gains (001 eq. 6.4-6.8) of a measurement of angle `i`, whose innovation has the square `square`."""
    cov = s.covariance
    S = cov[i, i] + doubted(p, variance, square, cov[i, i])
    for j in range(7):
        own[j] = cov[j, i]
        gain[j] = 0.0 if i == 2 and j < 2 else own[j] / S
    for j in range(7):
        for k in range(7):
            cov[j, k] += gain[j] * gain[k] * S - gain[j] * own[k] - own[j] * gain[k]


@njit(cache=True, nogil=True)
def walk(p, s):
    """Covariance of the bias over the time since the last correction."""
    for i in range(4, 7):
        s.covariance[i, i] += p.bias_walk * p.bias_walk * s.pending


@njit(cache=True, nogil=True)
def about(q, slope, axis):
    """Component of a gradient for rotations about east, north or up."""
    u = level_axis(q, axis)
    return u[0] * slope[0] + u[1] * slope[1] + u[2] * slope[2] + u[3] * slope[3]


@njit(cache=True, nogil=True)
def turn_linear(p, s, rate, dt):
    """Prediction of 001 eq. 6.10, its input the rates of the angles, which near the level are the gyroscope's."""
    roll, pitch = s.angles[0], s.angles[1]
    cosine = math.copysign(max(abs(math.cos(pitch)), p.least_cosine), math.cos(pitch))
    across = rate[1] * math.sin(roll) + rate[2] * math.cos(roll)
    s.angles[0] = wrap(roll + dt * (rate[0] + across * math.sin(pitch) / cosine))
    s.angles[1] = min(
        max(pitch + dt * (rate[1] * math.cos(roll) - rate[2] * math.sin(roll)), -0.5 * math.pi), 0.5 * math.pi
    )
    s.angles[2] = wrap(s.angles[2] + dt * across / cosine)
    from_angles(s.angles[0], s.angles[1], s.angles[2], s.q)


@njit(cache=True, nogil=True)
def linear(p, s, scratch, force, usable):
    """Linear Kalman filter of 001 6.1: roll and pitch, each with the bias of its own gyroscope."""
    f, gain, axes = s.mean_force, scratch[6], scratch[8:11, 0:3]
    angle = (math.atan2(f[1], f[2]), math.atan2(-f[0], math.hypot(f[1], f[2])))
    for i in range(3):
        for j in range(3):
            axes[i, j] = 1.0 if i == j else 0.0
    predict_angles(p, s, axes)
    for i in range(2):
        innovation = wrap(angle[i] - s.angles[i])
        if usable:
            measure_angle(p, s, i, tilt_variance(p, s, force), innovation * innovation, gain, scratch[5])
            s.angles[i] += gain[i] * innovation
            s.bias[i] += gain[4 + i] * innovation
        s.sigma[i] = math.sqrt(s.covariance[i, i])
    from_angles(s.angles[0], s.angles[1], s.angles[2], s.q)
