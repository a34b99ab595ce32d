"""Every numba function of the motion; imports nothing of the project, so that numba's cache is never stale.

Records are explained in `state`, `params` and `vehicle`, the method with its equations in `docs/motion.md`.
Abbreviations: `p` parameters, `c` vehicle (car), `s` state. Axes: `_v` vehicle, `_n` east, north, up. The order here is
that of a row: average an interval, move to the centre of gravity, predict, take the fix, take what is known of
vehicles, write.
"""

import math

import numpy as np
from numba import njit

GRAVITY = 9.80665
"""m/s2, standard gravity"""
EQUATOR, FLATTENING = 6378137.0, 0.0066943799901413
"""m and square of the eccentricity, WGS 84"""

POSITION, VELOCITY, ATTITUDE, GYRO_BIAS, BIAS, ARM = 0, 3, 6, 9, 12, 15
"""First index of each part of the error state: m east, north, up; m/s; rad about east, north, up; rad/s and m/s2 in
vehicle axes; m ahead and to the left."""
STATES = 17
RING = 128
"""intervals of the past that are kept"""
ROW = 22
"""columns of a row"""
MOST_LATENCY = 1.0
"""s"""
STALE = 3.0
"""s; two fixes further apart say nothing about a rate"""
MOST_SURPRISE = 10.0
"""squared Mahalanobis distance as which larger ones are learnt from"""
HOLD = 0.25
"""s for which a missing angular rate or steering angle is taken to be the last one"""
FULL_FORCE = 0.98
"""share of the friction limit beyond which a slip angle is not told from the force"""
STEP_LIMIT = 0.4
"""largest product of step and decay rate of the single-track model"""


# ------------------------------------------------------------------------------------------------------- geometry


@njit(cache=True, nogil=True)
def rotation_matrix(q, r):
    """R = R(q)."""
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
def half_turn(x, y, z):
    """Scalar and factor of the vector part of the quaternion that turns by the rotation vector (x, y, z)."""
    angle = math.sqrt(x * x + y * y + z * z)
    if angle < 1e-8:
        return 1.0, 0.5
    return math.cos(0.5 * angle), math.sin(0.5 * angle) / angle


@njit(cache=True, nogil=True)
def multiply(a, b, q):
    """Q = a * b, normalised; `q` may be one of them."""
    q0 = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]
    q1 = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2]
    q2 = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1]
    q3 = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]
    n = 1.0 / math.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    q[0], q[1], q[2], q[3] = q0 * n, q1 * n, q2 * n, q3 * n


@njit(cache=True, nogil=True)
def turn_left(q, x, y, z):
    """Q = dq * q: the rotation vector (x, y, z) in the axes that q turns to."""
    c, k = half_turn(x, y, z)
    multiply(np.array((c, k * x, k * y, k * z)), q, q)


@njit(cache=True, nogil=True)
def turn_right(q, x, y, z, out):
    """Out = q * dq: the rotation vector (x, y, z) in the axes that q turns from."""
    c, k = half_turn(x, y, z)
    multiply(q, np.array((c, k * x, k * y, k * z)), out)


@njit(cache=True, nogil=True)
def wrapped(angle):
    """Angle in [-pi, pi)."""
    return (angle + math.pi) % (2 * math.pi) - math.pi


@njit(cache=True, nogil=True)
def radii(latitude):
    """Metres north per radian of latitude and east per radian of longitude, at sea level."""
    sine = math.sin(latitude)
    w = 1.0 - FLATTENING * sine * sine
    across = EQUATOR / math.sqrt(w)
    return across * (1 - FLATTENING) / w, across * math.cos(latitude)


@njit(cache=True, nogil=True)
def rivals(w, dw, d, out):
    """Out = dw x d + w x (w x d): acceleration of a point of a rigid body less that of another, `d` from it (4)."""
    along = w[0] * d[0] + w[1] * d[1] + w[2] * d[2]
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    out[0] = dw[1] * d[2] - dw[2] * d[1] + w[0] * along - square * d[0]
    out[1] = dw[2] * d[0] - dw[0] * d[2] + w[1] * along - square * d[1]
    out[2] = dw[0] * d[1] - dw[1] * d[0] + w[2] * along - square * d[2]


@njit(cache=True, nogil=True)
def rivals_all(w, dw, d, out):
    """Apply `rivals` to each row."""
    for i in range(w.shape[0]):
        rivals(w[i], dw[i], d, out[i])


# ---------------------------------------------------------------------------------------------------------- tyres


@njit(cache=True, nogil=True)
def axle_force(slip, stiffness, most):
    """Lateral force of an axle and its derivative by the slip angle: brush model (Fiala 1954)."""
    x = stiffness * abs(slip) / (3.0 * most)
    if x >= 1.0:
        return math.copysign(most, slip), 0.0
    return math.copysign(most * (1 - (1 - x) ** 3), slip), stiffness * (1 - x) ** 2


@njit(cache=True, nogil=True)
def axle_slip(force, stiffness, most):
    """Slip angle at which an axle gives a force, and its derivative by the force; the inverse of `axle_force`."""
    share = min(abs(force) / most, FULL_FORCE)
    root = (1.0 - share) ** (1.0 / 3.0)
    return math.copysign(3.0 * most / stiffness * (1 - root), force), 1.0 / (stiffness * root * root)


@njit(cache=True, nogil=True)
def single_track(c, u, v, r, wheel):
    """Forces over mass and moments over inertia of the single-track model: dv/dt + u r and dr/dt, and their slopes.

    Gives (Fy / m, Mz / Iz, slope of the front axle, slope of the rear axle).
    """
    base = c["a1"] + c["a2"]
    weight = c["mass"] * GRAVITY * c["friction"]
    f1, s1 = axle_force(wheel - (v + c["a1"] * r) / u, c["cornering_stiffness_1"], weight * c["a2"] / base)
    f2, s2 = axle_force(-(v - c["a2"] * r) / u, c["cornering_stiffness_2"], weight * c["a1"] / base)
    return (f1 + f2) / c["mass"], (c["a1"] * f1 - c["a2"] * f2) / c["yaw_inertia"], s1, s2


@njit(cache=True, nogil=True)
def linearise(c, u, v, r, steer, out):
    """Write Q2, Q3, R2, R3, U2, U3, D2, D3, K2, K3 of (2), linearised about a state; `steer` at the steering wheel."""
    a1, a2, m, iz, ratio = c["a1"], c["a2"], c["mass"], c["yaw_inertia"], c["steering_ratio"]
    force, moment, s1, s2 = single_track(c, u, v, r, steer / ratio)
    out[0] = -(s1 + s2) / (m * u)
    out[1] = -(a1 * s1 - a2 * s2) / (iz * u)
    out[2] = -(a1 * s1 - a2 * s2) / (m * u) - u
    out[3] = -(a1 * a1 * s1 + a2 * a2 * s2) / (iz * u)
    front, rear = (v + a1 * r) / (u * u), (v - a2 * r) / (u * u)
    out[4] = (s1 * front + s2 * rear) / m - r
    out[5] = (a1 * s1 * front - a2 * s2 * rear) / iz
    out[6] = s1 / (m * ratio)
    out[7] = a1 * s1 / (iz * ratio)
    out[8] = force - u * r - (out[0] * v + out[2] * r + out[4] * u + out[6] * steer)
    out[9] = moment - (out[1] * v + out[3] * r + out[5] * u + out[7] * steer)


# --------------------------------------------------------------------------------------------------------- filter


@njit(cache=True, nogil=True)
def update(cov, dx, h, innovation, variance):
    """Scalar measurement `innovation = h dx + noise`: improves the error state `dx` and its covariance."""
    n = h.shape[0]
    ph = np.zeros(n)
    for j in range(n):
        if h[j] != 0.0:
            for i in range(n):
                ph[i] += cov[i, j] * h[j]
    total, left = variance, innovation
    for i in range(n):
        total += h[i] * ph[i]
        left -= h[i] * dx[i]
    for i in range(n):
        k = ph[i] / total
        dx[i] += k * left
        for j in range(i + 1):
            cov[i, j] -= k * ph[j]
            cov[j, i] = cov[i, j]


@njit(cache=True, nogil=True)
def fold(p, s, dx):
    """Take the error state into the state, the past included as far as late fixes may ask for it."""
    place, v, bias, gyro_bias, q = s["place"], s["v_n"], s["bias"], s["gyro_bias"], s["q_nv"]
    north, east = radii(place[0])
    correct_past(p, s, dx, north, east)
    place[0] += dx[POSITION + 1] / north
    place[1] += dx[POSITION] / east
    place[2] += dx[POSITION + 2]
    for i in range(3):
        v[i] += dx[VELOCITY + i]
        gyro_bias[i] += dx[GYRO_BIAS + i]
        bias[i] += dx[BIAS + i]
    s["arm"][0] += dx[ARM]
    s["arm"][1] += dx[ARM + 1]
    turn_left(q, dx[ATTITUDE], dx[ATTITUDE + 1], dx[ATTITUDE + 2])


@njit(cache=True, nogil=True)
def correct_past(p, s, dx, north, east):
    """Correct what was predicted of the past as the present was: an error of velocity or attitude is an old one."""
    t, past_v, past_p, v = s["ring_t"], s["ring_v"], s["ring_p"], s["v_n"]
    newest = s["ring_head"]
    a0, a1, a2 = dx[ATTITUDE], dx[ATTITUDE + 1], dx[ATTITUDE + 2]
    for k in range(s["ring_count"]):
        i = (newest - k) % RING
        age = t[newest] - t[i]
        if age > p["latency"] + 0.5:
            break
        d0, d1, d2 = past_v[i, 0] - v[0], past_v[i, 1] - v[1], past_v[i, 2] - v[2] - GRAVITY * age
        past_v[i, 0] += dx[VELOCITY] + a1 * d2 - a2 * d1
        past_v[i, 1] += dx[VELOCITY + 1] + a2 * d0 - a0 * d2
        past_v[i, 2] += dx[VELOCITY + 2] + a0 * d1 - a1 * d0
        past_p[i, 0] += (dx[POSITION + 1] - age * dx[VELOCITY + 1]) / north
        past_p[i, 1] += (dx[POSITION] - age * dx[VELOCITY]) / east
        past_p[i, 2] += dx[POSITION + 2] - age * dx[VELOCITY + 2]


@njit(cache=True, nogil=True)
def predict_mean(s, w, f, dt, r):
    """Carry attitude, velocity and position on by `dt` with the mean rate and force; `r` becomes the attitude midway.

    Equation (1) in east, north, up: there the term of the yaw rate is gone, and gravity is a constant.
    """
    q, v, place = s["q_nv"], s["v_n"], s["place"]
    middle = np.empty(4)
    turn_right(q, 0.5 * dt * w[0], 0.5 * dt * w[1], 0.5 * dt * w[2], middle)
    rotation_matrix(middle, r)
    turn_right(q, dt * w[0], dt * w[1], dt * w[2], q)
    north, east = radii(place[0])
    change = np.empty(3)
    for i in range(3):
        change[i] = dt * (r[i, 0] * f[0] + r[i, 1] * f[1] + r[i, 2] * f[2])
    change[2] -= dt * GRAVITY
    place[0] += dt * (v[1] + 0.5 * change[1]) / north
    place[1] += dt * (v[0] + 0.5 * change[0]) / east
    place[2] += dt * (v[2] + 0.5 * change[2])
    for i in range(3):
        v[i] += change[i]


@njit(cache=True, nogil=True)
def transition(r, f, w, dw, gyro, b):
    """Write the blocks of the error state's derivative: velocity by attitude, bias, arm; attitude by the rate's bias.

    b[0] = -[R f]x, b[1] = -R, b[2] = -R ([dw]x + [w]x^2), b[3] = -R, or zero without a gyroscope.
    """
    x = r[0, 0] * f[0] + r[0, 1] * f[1] + r[0, 2] * f[2]
    y = r[1, 0] * f[0] + r[1, 1] * f[1] + r[1, 2] * f[2]
    z = r[2, 0] * f[0] + r[2, 1] * f[1] + r[2, 2] * f[2]
    b[0, 0, 0], b[0, 0, 1], b[0, 0, 2] = 0.0, z, -y
    b[0, 1, 0], b[0, 1, 1], b[0, 1, 2] = -z, 0.0, x
    b[0, 2, 0], b[0, 2, 1], b[0, 2, 2] = y, -x, 0.0
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    for i in range(3):
        along = r[i, 0] * w[0] + r[i, 1] * w[1] + r[i, 2] * w[2]
        b[2, i, 0] = -(along * w[0] - square * r[i, 0] + r[i, 1] * dw[2] - r[i, 2] * dw[1])
        b[2, i, 1] = -(along * w[1] - square * r[i, 1] + r[i, 2] * dw[0] - r[i, 0] * dw[2])
        b[2, i, 2] = 0.0  # the height of the device is taken as given
        for j in range(3):
            b[1, i, j] = -r[i, j]
            b[3, i, j] = -r[i, j] if gyro else 0.0


@njit(cache=True, nogil=True)
def predict_covariance(cov, b, dt):
    """Cov = F cov F', F = 1 + dt times the blocks; from the top row down, since each needs those below as they were."""
    for _ in range(2):  # F cov, then again on the transpose
        for j in range(STATES):
            for i in range(3):
                cov[i, j] += dt * cov[VELOCITY + i, j]
            for i in range(3):
                change = b[2, i, 0] * cov[ARM, j] + b[2, i, 1] * cov[ARM + 1, j]
                for k in range(3):
                    change += b[0, i, k] * cov[ATTITUDE + k, j] + b[1, i, k] * cov[BIAS + k, j]
                cov[VELOCITY + i, j] += dt * change
            for i in range(3):
                change = 0.0
                for k in range(3):
                    change += b[3, i, k] * cov[GYRO_BIAS + k, j]
                cov[ATTITUDE + i, j] += dt * change
        for i in range(STATES):
            for j in range(i):
                cov[i, j], cov[j, i] = cov[j, i], cov[i, j]


@njit(cache=True, nogil=True)
def add_noise(p, cov, gyro, dt):
    """Process noise of an interval."""
    turning = p["rate_noise"] if gyro else p["rate_noise_without_gyro"]
    for i in range(3):
        cov[VELOCITY + i, VELOCITY + i] += p["force_noise"] ** 2 * dt
        cov[ATTITUDE + i, ATTITUDE + i] += turning**2 * dt
        cov[GYRO_BIAS + i, GYRO_BIAS + i] += p["gyro_bias_walk"] ** 2 * dt
        cov[BIAS + i, BIAS + i] += p["bias_walk"] ** 2 * dt


# ---------------------------------------------------------------------------------------------------------- fixes


@njit(cache=True, nogil=True)
def keep_past(s, r):
    """Write the device's velocity and place into the ring."""
    i = (s["ring_head"] + 1) % RING
    s["ring_head"] = i
    s["ring_count"] = min(s["ring_count"] + 1, RING)
    w, arm, place, v = s["w_v"], s["arm"], s["place"], s["v_n"]
    x = w[1] * arm[2] - w[2] * arm[1]
    y = w[2] * arm[0] - w[0] * arm[2]
    z = w[0] * arm[1] - w[1] * arm[0]
    north, east = radii(place[0])
    s["ring_t"][i] = s["t"]
    for k in range(3):
        s["ring_v"][i, k] = v[k] + r[k, 0] * x + r[k, 1] * y + r[k, 2] * z
    s["ring_p"][i, 0] = place[0] + (r[1, 0] * arm[0] + r[1, 1] * arm[1] + r[1, 2] * arm[2]) / north
    s["ring_p"][i, 1] = place[1] + (r[0, 0] * arm[0] + r[0, 1] * arm[1] + r[0, 2] * arm[2]) / east
    s["ring_p"][i, 2] = place[2] + r[2, 0] * arm[0] + r[2, 1] * arm[1] + r[2, 2] * arm[2]


@njit(cache=True, nogil=True)
def look_back(s, t, v, place):
    """Velocity and place of the device at a time of the past, as they are seen now."""
    head = s["ring_head"]
    k = 0
    while k < s["ring_count"] - 2 and s["ring_t"][(head - k - 1) % RING] > t:
        k += 1
    after = (head - k) % RING
    before = (after - 1) % RING if s["ring_count"] > 1 else after
    span = s["ring_t"][after] - s["ring_t"][before]
    x = 1.0 if span <= 0.0 else min(max((t - s["ring_t"][before]) / span, 0.0), 2.0)
    for i in range(3):
        v[i] = s["ring_v"][before, i] + x * (s["ring_v"][after, i] - s["ring_v"][before, i])
        place[i] = s["ring_p"][before, i] + x * (s["ring_p"][after, i] - s["ring_p"][before, i])


@njit(cache=True, nogil=True)
def note_fix(p, s):
    """Complete the waiting fix from the one before, and remember it: velocity from positions, the rate of the course.

    Gives the s by which its velocity is older than its position.
    """
    fix, before, t = s["fix"], s["fix_place"], s["fix_t"]
    since, delay = t - s["fix_place_t"], 0.0
    placed = not (math.isnan(fix[0]) or math.isnan(fix[1]))
    if math.isnan(fix[3]) and placed and 0.0 < since < STALE:
        north, east = radii(fix[0])
        y, x = (fix[0] - before[0]) * north, (fix[1] - before[1]) * east
        fix[3], fix[4], delay = math.hypot(x, y) / since, math.atan2(x, y), 0.5 * since
        fix[6] = 0.5 / since  # m/s: half a metre of noise between neighbours
    if placed:
        before[:] = fix[:3]
        s["fix_place_t"] = t
    since = t - s["fix_course_t"]
    if fix[3] > p["walking_pace"] and not math.isnan(fix[4]):
        if 0.0 < since < STALE:
            s["course_rate"] = -wrapped(fix[4] - s["fix_course"]) / since
        s["fix_course"], s["fix_course_t"] = fix[4], t
    else:
        s["course_rate"] = 0.0
    since = t - s["last_fix_t"]
    if 0.0 < since < STALE:
        s["fix_interval"] += 0.2 * (since - s["fix_interval"])
    s["last_fix_t"], s["fix_speed"] = t, fix[3]
    return delay


@njit(cache=True, nogil=True)
def velocity_row(r, v, w, d, h):
    """Row of H for the device's velocity along the unit vector `d`: d, v x d, and d R [w]x for the arm.

    `v` is what an error of the attitude turns: that velocity less the velocity of the centre of gravity now, and for a
    time of the past the gravity since then, which the specific force has had to carry.
    """
    h[:] = 0.0
    for i in range(3):
        h[VELOCITY + i] = d[i]
    h[ATTITUDE] = v[1] * d[2] - v[2] * d[1]
    h[ATTITUDE + 1] = v[2] * d[0] - v[0] * d[2]
    h[ATTITUDE + 2] = v[0] * d[1] - v[1] * d[0]
    x = r[0, 0] * d[0] + r[1, 0] * d[1] + r[2, 0] * d[2]
    y = r[0, 1] * d[0] + r[1, 1] * d[1] + r[2, 1] * d[2]
    z = r[0, 2] * d[0] + r[1, 2] * d[1] + r[2, 2] * d[2]
    h[ARM] = y * w[2] - z * w[1]
    h[ARM + 1] = z * w[0] - x * w[2]


@njit(cache=True, nogil=True)
def spread(cov, h):
    """H cov h'."""
    total = 0.0
    for i in range(STATES):
        if h[i] != 0.0:
            for j in range(STATES):
                total += h[i] * cov[i, j] * h[j]
    return total


@njit(cache=True, nogil=True)
def correlated(variance, correlation, interval):
    """Variance that makes measurements whose errors stay the same count as much as they tell."""
    return variance * max(1.0, correlation / max(interval, 1e-3))


@njit(cache=True, nogil=True)
def learn_noise(p, s, distance):
    """Believe a receiver less whose velocities keep missing the prediction; `distance` is 2 on average."""
    gain = min(s["fix_interval"] / p["velocity_learning"], 0.3)
    factor = s["velocity_factor"] * math.exp(gain * (0.5 * min(distance, MOST_SURPRISE) - 1.0))
    s["velocity_factor"] = min(max(factor, 1.0), p["velocity_distrust"])


@njit(cache=True, nogil=True)
def take_velocity(p, s, r, v, age, dx):
    """Velocity of the fix of `age` s, along its direction and across. False when it is not believed."""
    fix, cov = s["fix"], s["covariance"]
    speed, course = fix[3], fix[4]
    if math.isnan(speed):
        return True
    sigma = p["velocity"] if math.isnan(fix[6]) else max(fix[6], 0.03)
    along = s["velocity_factor"] * correlated(sigma**2, p["velocity_correlation"], s["fix_interval"])
    across = along
    if not math.isnan(fix[7]):
        sigma = max(speed, 0.5) * fix[7]
        across = s["velocity_factor"] * correlated(sigma**2, p["velocity_correlation"], s["fix_interval"])
    if math.isnan(course):  # the speed alone, along the motion as it is seen
        course = math.atan2(v[0], v[1])
        across = np.inf if speed > p["walking_pace"] else across
    d, h1, h2, turned = np.zeros(3), np.empty(STATES), np.empty(STATES), np.empty(3)
    for i in range(3):
        turned[i] = v[i] - s["v_n"][i]
    turned[2] -= GRAVITY * age
    d[0], d[1] = math.sin(course), math.cos(course)
    e1 = speed - d[0] * v[0] - d[1] * v[1]
    velocity_row(r, turned, s["w_v"], d, h1)
    d[0], d[1] = d[1], -d[0]
    e2 = -d[0] * v[0] - d[1] * v[1]
    velocity_row(r, turned, s["w_v"], d, h2)
    distance = e1 * e1 / (spread(cov, h1) + along) + e2 * e2 / (spread(cov, h2) + across)
    learn_noise(p, s, distance if across < np.inf else 2 * distance)
    if distance > p["gate"]:
        return False
    update(cov, dx, h1, e1, along)
    if across < np.inf:
        update(cov, dx, h2, e2, across)
    if not math.isnan(fix[5]):
        d[:] = 0.0
        d[2] = 1.0
        velocity_row(r, turned, s["w_v"], d, h1)
        variance = correlated(p["vertical_velocity"] ** 2, p["velocity_correlation"], s["fix_interval"])
        update(cov, dx, h1, fix[5] - v[2], variance)
    return True


@njit(cache=True, nogil=True)
def take_position(p, s, place, age, dx):
    """Position of the fix; one that is not believed moves the vehicle there."""
    fix, cov, h = s["fix"], s["covariance"], np.zeros(STATES)
    if math.isnan(fix[0]) or math.isnan(fix[1]):
        return
    if not s["placed"]:
        set_place(p, s)
        return
    north, east = radii(place[0])
    offset = ((fix[1] - place[1]) * east, (fix[0] - place[0]) * north, fix[2] - place[2])
    for i in range(3):
        if math.isnan(offset[i]):
            continue
        sigma = p["position"] if i < 2 else p["altitude"]
        h[:] = 0.0
        h[POSITION + i], h[VELOCITY + i] = 1.0, -age
        if offset[i] ** 2 > p["gate"] * (spread(cov, h) + 4 * sigma**2):
            cov[POSITION + i, POSITION + i] += offset[i] ** 2
        update(cov, dx, h, offset[i], correlated(sigma**2, p["position_correlation"], s["fix_interval"]))


@njit(cache=True, nogil=True)
def set_place(p, s):
    """Begin at the position of the waiting fix; the first of all is the origin."""
    cov, fix = s["covariance"], s["fix"]
    s["place"][:] = fix[:3]
    if math.isnan(fix[2]):
        s["place"][2] = 0.0
    if math.isnan(s["origin"][0]):
        s["origin"][:] = fix[:3]
    for i in range(3):
        cov[POSITION + i, :] = 0.0
        cov[:, POSITION + i] = 0.0
        cov[POSITION + i, POSITION + i] = (p["position"] if i < 2 else p["altitude"]) ** 2
    s["placed"] = True
    s["ring_count"] = 0


@njit(cache=True, nogil=True)
def take_fix(p, c, s, r):
    """Use the waiting fix: to start, or to correct."""
    t = s["fix_t"]
    delay = note_fix(p, s)
    if s["fix_speed"] < p["still_speed"]:
        rest(p, s, t)
    if not s["running"]:
        start(p, c, s)
        return
    v, place, dx = np.empty(3), np.empty(3), np.zeros(STATES)
    age = s["t"] - t + p["latency"]
    look_back(s, s["t"] - age, v, place)
    take_position(p, s, place, age, dx)
    if s["ring_count"] == 0:
        keep_past(s, r)
    look_back(s, s["t"] - age - delay, v, place)
    if take_velocity(p, s, r, v, age + delay, dx):
        stand(p, s, v, dx)
        s["doubted_since"] = np.nan
        fold(p, s, dx)
    elif math.isnan(s["doubted_since"]):
        s["doubted_since"] = t
    elif t - s["doubted_since"] > p["patience"]:
        s["running"] = False


@njit(cache=True, nogil=True)
def rest(p, s, t):
    """Remember the force at rest; one that differs is of a vehicle that sets off before its fixes say so."""
    force, mean, change = s["f_v"], s["rest_f"], 0.0
    if math.isnan(s["rest_t"]):
        mean[:] = force
    for i in range(3):
        change = max(change, abs(force[i] - mean[i]))
    if change < p["still_force"]:
        for i in range(3):
            mean[i] += 0.3 * (force[i] - mean[i])
    s["rest_t"], s["impulse"] = t, 0.0


@njit(cache=True, nogil=True)
def stand(p, s, v, dx):
    """A fix of a standing vehicle: its velocity is zero, and the gyroscope reads its bias."""
    w, h = s["w_v"], np.empty(STATES)
    turning = math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    if not (s["fix_speed"] < p["still_speed"] and turning < p["still_rate"]):
        return
    for i in range(3):
        h[:] = 0.0
        h[VELOCITY + i] = 1.0
        update(s["covariance"], dx, h, -v[i], p["still_velocity"] ** 2)
        h[:] = 0.0
        h[GYRO_BIAS + i] = 1.0
        update(s["covariance"], dx, h, w[i], p["still_rate"] ** 2)


@njit(cache=True, nogil=True)
def start(p, c, s):
    """Start the filter from a fix in motion: heading from its course, roll and pitch from standing or level."""
    fix, q, rest = s["fix"], s["q_nv"], s["rest_f"]
    if not fix[3] >= p["start_speed"] or math.isnan(fix[4]):
        return
    heading, roll, pitch = 0.5 * math.pi - fix[4], 0.0, 0.0
    if s["fix_t"] - s["rest_t"] < STALE * 5:
        roll = math.atan2(rest[1], rest[2])
        pitch = -math.atan2(rest[0], math.hypot(rest[1], rest[2]))
        if s["impulse"] < -0.25 * fix[3]:
            heading += math.pi  # the forward force since then has been against the motion: it reverses
    q[0], q[1], q[2], q[3] = math.cos(0.5 * heading), 0.0, 0.0, math.sin(0.5 * heading)
    turn_right(q, 0.0, pitch, 0.0, q)
    turn_right(q, roll, 0.0, 0.0, q)
    v = s["v_n"]
    v[0], v[1], v[2] = fix[3] * math.sin(fix[4]), fix[3] * math.cos(fix[4]), 0.0
    first = math.isnan(s["arm"][0])
    start_covariance(p, s["covariance"], fix[3], first, not math.isnan(c["device"][0]))
    if first:
        for i in range(3):
            s["arm"][i] = 0.0 if math.isnan(c["device"][i]) else c["device"][i]
    s["placed"] = False
    if not (math.isnan(fix[0]) or math.isnan(fix[1])):
        set_place(p, s)
    s["running"], s["bicycle_running"] = True, False
    s["doubted_since"] = np.nan
    s["ring_count"] = 0
    s["constraint_t"] = s["t"]


@njit(cache=True, nogil=True)
def start_covariance(p, cov, speed, first, measured):
    """Covariance at a start; what is known of biases and arm is kept unless it is the first."""
    cov[: ATTITUDE + 3, :] = 0.0
    cov[:, : ATTITUDE + 3] = 0.0
    for i in range(3):
        cov[VELOCITY + i, VELOCITY + i] = 1.0
        cov[ATTITUDE + i, ATTITUDE + i] = p["start_tilt"] ** 2
    cov[ATTITUDE + 2, ATTITUDE + 2] = p["start_heading"] ** 2 + (2 * p["velocity"] / speed) ** 2
    if first:
        cov[GYRO_BIAS:, GYRO_BIAS:] = 0.0
        for i in range(3):
            cov[GYRO_BIAS + i, GYRO_BIAS + i] = p["gyro_bias"] ** 2
            cov[BIAS + i, BIAS + i] = p["bias"] ** 2
        cov[ARM, ARM] = cov[ARM + 1, ARM + 1] = (p["measured_arm"] if measured else p["arm"]) ** 2


# -------------------------------------------------------------------------------------------- what vehicles can do


@njit(cache=True, nogil=True)
def body_row(r, v, axis, h):
    """Row of H for the velocity along an axis of the vehicle, and that velocity."""
    h[:] = 0.0
    for i in range(3):
        h[VELOCITY + i] = r[i, axis]
    h[ATTITUDE] = r[1, axis] * v[2] - r[2, axis] * v[1]
    h[ATTITUDE + 1] = r[2, axis] * v[0] - r[0, axis] * v[2]
    h[ATTITUDE + 2] = r[0, axis] * v[1] - r[1, axis] * v[0]
    return v[0] * r[0, axis] + v[1] * r[1, axis] + v[2] * r[2, axis]


@njit(cache=True, nogil=True)
def road_force(c, s):
    """M/s2: lateral force of the tyres over the mass; the reading less the lean of the body, which is linear in it."""
    return s["force"][1] / (1.0 + GRAVITY * c["roll_gradient"])


@njit(cache=True, nogil=True)
def rear_axle(p, c, u, r, force):
    """Lateral velocity and its sigma, from the slip of the rear axle under the force F2 on it."""
    most = c["mass"] * GRAVITY * c["friction"] * c["a1"] / (c["a1"] + c["a2"])
    slip, slope = axle_slip(force, c["cornering_stiffness_2"], most)
    near_limit = p["force_share"] * abs(force) * (slope - 1 / c["cornering_stiffness_2"])
    doubt = math.hypot(p["slip"], p["slip_share"] * slip) + near_limit
    return c["a2"] * r - abs(u) * math.tan(slip), math.hypot(abs(u) * doubt, 0.02)


@njit(cache=True, nogil=True)
def rear_force(c, dr, force):
    """F2 in N from the motion: moments about the front axle, F2 (a1 + a2) = a1 m fy - Iz dr/dt."""
    return (c["a1"] * c["mass"] * force - c["yaw_inertia"] * dr) / (c["a1"] + c["a2"])


@njit(cache=True, nogil=True)
def step_bicycle(p, c, s, r, u, steer, dt):
    """Dynamic single-track model (2): predict with speed and steering, correct with yaw rate and lateral force."""
    x, cov = s["bicycle"], s["bicycle_covariance"]
    force = road_force(c, s)
    if not s["bicycle_running"]:
        v = s["v_n"]
        x[0] = v[0] * r[0, 1] + v[1] * r[1, 1] + v[2] * r[2, 1]
        x[1] = s["w_v"][2]
        cov[:] = 0.0
        cov[0, 0], cov[1, 1] = 0.3**2, 0.05**2
        s["bicycle_running"] = True
    bank = -GRAVITY * (r[2, 1] - c["roll_gradient"] * force)  # m/s2, the road's, without the lean of the body
    k = np.empty(10)
    linearise(c, u, x[0], x[1], steer, k)
    count = 1 + int(-dt * min(k[0], k[3]) / STEP_LIMIT)
    step = dt / count
    for _ in range(count):
        linearise(c, u, x[0], x[1], steer, k)
        dv = k[0] * x[0] + k[2] * x[1] + k[4] * u + k[6] * steer + k[8] + bank
        dr = k[1] * x[0] + k[3] * x[1] + k[5] * u + k[7] * steer + k[9]
        x[0] += step * dv
        x[1] += step * dr
        spread_bicycle(p, cov, k, step)
    modelled, _, s1, s2 = single_track(c, u, x[0], x[1], steer / c["steering_ratio"])
    h, dx = np.zeros(2), np.zeros(2)
    h[1] = 1.0
    update(cov, dx, h, s["w_v"][2] - x[1], correlated(p["bicycle_rate"] ** 2, p["constraint_interval"], dt))
    h[0] = -(s1 + s2) / (c["mass"] * u)
    h[1] = -(c["a1"] * s1 - c["a2"] * s2) / (c["mass"] * u)
    update(cov, dx, h, force - modelled, correlated(p["bicycle_force"] ** 2, p["constraint_correlation"], dt))
    x[0] += dx[0]
    x[1] += dx[1]


@njit(cache=True, nogil=True)
def spread_bicycle(p, cov, k, dt):
    """Cov = F cov F' + Q with F of (2)."""
    f00, f01, f10, f11 = 1 + dt * k[0], dt * k[2], dt * k[1], 1 + dt * k[3]
    a, b, d = cov[0, 0], cov[0, 1], cov[1, 1]
    cov[0, 0] = f00 * f00 * a + 2 * f00 * f01 * b + f01 * f01 * d + p["bicycle_velocity_noise"] ** 2 * dt
    cov[1, 1] = f10 * f10 * a + 2 * f10 * f11 * b + f11 * f11 * d + p["bicycle_rate_noise"] ** 2 * dt
    cov[0, 1] = cov[1, 0] = f00 * f10 * a + (f00 * f11 + f01 * f10) * b + f01 * f11 * d


@njit(cache=True, nogil=True)
def constrain(p, c, s, r, gyro):
    """Measurements nobody makes: lateral velocity as the tyres allow it, and none off the road."""
    cov, v, w, h, dx = s["covariance"], s["v_n"], s["w_v"], np.empty(STATES), np.zeros(STATES)
    interval = p["constraint_interval"]
    correlation = p["constraint_correlation"] + min(s["t"] - s["last_fix_t"], p["outage_correlation"])
    u = body_row(r, v, 0, h)
    expected, sigma = rear_axle(p, c, u, w[2], rear_force(c, s["dw_v"][2], road_force(c, s)))
    if s["bicycle_running"]:
        expected, sigma = s["bicycle"][0], math.hypot(sigma, math.sqrt(s["bicycle_covariance"][0, 0]))
    lateral = body_row(r, v, 1, h)
    update(cov, dx, h, expected - lateral, correlated(sigma**2, correlation, interval))
    upward = body_row(r, v, 2, h)
    sigma = p["heave"] + p["heave_share"] * abs(u)
    update(cov, dx, h, -upward, correlated(sigma**2, correlation, interval))
    if not gyro:
        level(p, r, cov, dx, h)
    fold(p, s, dx)


@njit(cache=True, nogil=True)
def level(p, r, cov, dx, h):
    """Without a gyroscope: roads are nearly level."""
    variance = correlated(p["start_tilt"] ** 2, p["position_correlation"], p["constraint_interval"])
    for axis in range(2):  # the vehicle's upward axis leans by the errors about north and east
        h[:] = 0.0
        h[ATTITUDE + 1 - axis] = 1.0 - 2.0 * axis
        update(cov, dx, h, -r[axis, 2], variance)


# ----------------------------------------------------------------------------------------------------------- rows


@njit(cache=True, nogil=True)
def take_interval(p, c, s, r_vs, row):
    """Close the interval: one step of everything, one row."""
    n, r = s["count"], np.empty((3, 3))
    t = s["sum_t"] / n
    gyro = s["gyro_count"] > 0
    if s["steer_count"] > 0:
        s["steer"], s["steer_t"] = s["sum_steer"] / s["steer_count"], t
    steer = s["steer"] if t - s["steer_t"] < HOLD else np.nan
    dt = t - s["t"]
    f, w = np.empty(3), np.zeros(3)
    for i in range(3):
        f[i] = (r_vs[i, 0] * s["sum_f"][0] + r_vs[i, 1] * s["sum_f"][1] + r_vs[i, 2] * s["sum_f"][2]) / n
        if gyro:
            w[i] = (r_vs[i, 0] * s["sum_w"][0] + r_vs[i, 1] * s["sum_w"][1] + r_vs[i, 2] * s["sum_w"][2]) / s[
                "gyro_count"
            ] - s["gyro_bias"][i]
    if gyro:
        s["gyro_t"] = t
    elif t - s["gyro_t"] < HOLD:
        gyro = True
        w[:] = s["w_v"]
    else:
        w[2] = s["course_rate"]
    if not dt <= p["max_gap"]:
        s["running"], dt = False, 0.0
        s["smooth_w"][:] = w
        s["rest_t"] = np.nan
    s["t"] = t
    move(p, s, f, w, dt, r, gyro)
    if s["fix_waits"]:
        s["fix_waits"] = False
        take_fix(p, c, s, r)
        rotation_matrix(s["q_nv"], r)
    if s["running"]:
        u = s["v_n"][0] * r[0, 0] + s["v_n"][1] * r[1, 0] + s["v_n"][2] * r[2, 0]
        if gyro and u > p["bicycle_speed"] and not math.isnan(steer):
            step_bicycle(p, c, s, r, u, steer, dt)
        else:
            s["bicycle_running"] = False
        if t - s["constraint_t"] >= p["constraint_interval"] - 1e-6:
            s["constraint_t"] = t
            constrain(p, c, s, r, gyro)
            rotation_matrix(s["q_nv"], r)
    write_row(p, s, r, gyro, row)


@njit(cache=True, nogil=True)
def move(p, s, f, w, dt, r, gyro):
    """Filtered rate and its derivative, the force moved to the centre of gravity, and the prediction."""
    smooth, dw, d = s["smooth_w"], s["dw_v"], np.empty(3)
    share = 1.0 - math.exp(-dt / p["rate_smoothing"])
    for i in range(3):
        smooth[i] += share * (w[i] - smooth[i])
        dw[i] = (w[i] - smooth[i]) / p["rate_smoothing"] if gyro else 0.0
    force, arm = np.zeros(3), s["arm"]
    if not math.isnan(arm[0]):
        for i in range(3):
            d[i] = -arm[i]
        rivals(smooth, dw, d, force)
    for i in range(3):
        force[i] += f[i] - s["bias"][i]
    if s["running"]:
        mean_f, mean_w, blocks = np.empty(3), np.empty(3), np.zeros((4, 3, 3))
        for i in range(3):
            mean_f[i] = 0.5 * (force[i] + s["force"][i])
            mean_w[i] = 0.5 * (w[i] + s["w_v"][i])
        predict_mean(s, mean_w, mean_f, dt, r)
        transition(r, mean_f, smooth, dw, gyro, blocks)
        predict_covariance(s["covariance"], blocks, dt)
        add_noise(p, s["covariance"], gyro, dt)
    else:
        s["impulse"] += dt * (f[0] - s["rest_f"][0])
    s["force"][:] = force
    s["f_v"][:] = f
    s["w_v"][:] = w
    rotation_matrix(s["q_nv"], r)
    if s["running"]:
        keep_past(s, r)


@njit(cache=True, nogil=True)
def write_row(p, s, r, gyro, row):
    """The columns that `reconstruct` names."""
    row[:] = np.nan
    row[0] = s["t"]
    row[8:11] = s["w_v"]
    row[21] = 0.0 if s["t"] - s["last_fix_t"] < 1.5 * s["fix_interval"] + 0.1 else 1.0
    for i in range(3):
        row[5 + i] = s["force"][i] - GRAVITY * (r[2, i] if s["running"] else (1.0 if i == 2 else 0.0))
    if not s["running"]:
        return
    cov, v, h = s["covariance"], s["v_n"], np.empty(STATES)
    row[1:5] = s["q_nv"]
    for axis in range(2):
        row[11 + axis] = body_row(r, v, axis, h)
        row[13 + axis] = math.sqrt(max(spread(cov, h), 0.0))
    speed = math.hypot(row[11], row[12])
    if gyro and speed > p["walking_pace"]:
        row[15] = math.atan2(row[12], row[11])
        row[16] = math.hypot(row[14], row[15] * row[13]) / speed
    if s["placed"]:
        place, origin = s["place"], s["origin"]
        north, east = radii(origin[0])
        row[17] = wrapped(place[1] - origin[1]) * east
        row[18] = (place[0] - origin[0]) * north
        row[19] = place[2] - (0.0 if math.isnan(origin[2]) else origin[2])
        spread_p = 0.5 * (cov[POSITION, POSITION] + cov[POSITION + 1, POSITION + 1])
        row[20] = math.sqrt(max(spread_p, 0.0) + p["position"] ** 2)


@njit(cache=True, nogil=True)
def run(params, vehicle, state, r_vs, t, f_s, w_s, steer, fix_row, fix_valid, fix, rows):
    """Take all samples; mutates the state; gives the number of rows."""
    p, c, s = params[0], vehicle[0], state[0]
    count, next_fix = 0, 0
    sum_f, sum_w = s["sum_f"], s["sum_w"]
    for i in range(t.shape[0]):
        if not t[i] <= s["sample_t"]:
            interval = math.floor(t[i] * p["rate"] + 1e-6)
            if s["count"] > 0 and interval != s["interval"]:
                take_interval(p, c, s, r_vs, rows[count])
                count += 1
                s["count"] = 0
            if s["count"] == 0:
                s["interval"] = interval
                s["gyro_count"] = s["steer_count"] = 0
                s["sum_t"] = s["sum_steer"] = 0.0
                sum_f[:] = 0.0
                sum_w[:] = 0.0
            s["sample_t"] = t[i]
            s["count"] += 1
            s["sum_t"] += t[i]
            for k in range(3):
                sum_f[k] += f_s[i, k]
            if not (math.isnan(w_s[i, 0]) or math.isnan(w_s[i, 1]) or math.isnan(w_s[i, 2])):
                s["gyro_count"] += 1
                for k in range(3):
                    sum_w[k] += w_s[i, k]
            if steer.shape[0] and not math.isnan(steer[i]):
                s["steer_count"] += 1
                s["sum_steer"] += steer[i]
        if next_fix < fix_row.shape[0] and fix_row[next_fix] == i:
            if fix_valid[next_fix]:
                s["fix_waits"], s["fix_t"] = True, t[i]
                s["fix"][:] = fix[next_fix]
            next_fix += 1
    return count
