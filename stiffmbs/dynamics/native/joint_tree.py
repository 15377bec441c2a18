"""Motion, inertia and forces of a spanning tree of joints in joint coordinates.

The product of the exponentials of its screws moves a frame from its reference pose. Source: Murray, Li and Sastry, A Mathematical
Introduction to Robotic Manipulation (1994), section 3.2. Velocities and their rates are spatial vectors in
ground axes at the origin (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 2.9).
"""

from math import cos, sin, sqrt

from stiffmbs.compile.machine.native.access import compiled, room, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, MOTION, evaluate
from stiffmbs.dynamics.native.layouts import BODY, FRAME
from stiffmbs.dynamics.native.views import joint_tree_view

PLACE, MATRIX, VELOCITY, RATE, ANGLE = 4, 7, 16, 22, 28
"""First numbers of the parts of a frame after the quaternion."""


@compiled
def _times(p, other, product):
    """Multiply quaternions."""
    a, b, c, d = p[0], p[1], p[2], p[3]
    w, x, y, z = other[0], other[1], other[2], other[3]
    product[0] = a * w - b * x - c * y - d * z
    product[1] = a * x + b * w + c * z - d * y
    product[2] = a * y - b * z + c * w + d * x
    product[3] = a * z + b * y - c * x + d * w


@compiled
def _matrix(p, m):
    """Store the rotation matrix of a unit quaternion by rows."""
    w, x, y, z = p[0], p[1], p[2], p[3]
    m[0] = w * w + x * x - y * y - z * z
    m[1] = 2.0 * (x * y - w * z)
    m[2] = 2.0 * (x * z + w * y)
    m[3] = 2.0 * (x * y + w * z)
    m[4] = w * w - x * x + y * y - z * z
    m[5] = 2.0 * (y * z - w * x)
    m[6] = 2.0 * (x * z - w * y)
    m[7] = 2.0 * (y * z + w * x)
    m[8] = w * w - x * x - y * y + z * z


@compiled
def _turned(m, v, found):
    """Multiply a matrix and a vector, which may be the result."""
    a, b, c = v[0], v[1], v[2]
    found[0] = m[0] * a + m[1] * b + m[2] * c
    found[1] = m[3] * a + m[4] * b + m[5] * c
    found[2] = m[6] * a + m[7] * b + m[8] * c


@compiled
def _turned_back(m, v, found):
    """Multiply the transpose of a matrix and a vector, which may be the result."""
    a, b, c = v[0], v[1], v[2]
    found[0] = m[0] * a + m[3] * b + m[6] * c
    found[1] = m[1] * a + m[4] * b + m[7] * c
    found[2] = m[2] * a + m[5] * b + m[8] * c


@compiled
def _add_cross(a, b, found):
    """Add a vector product."""
    found[0] += a[1] * b[2] - a[2] * b[1]
    found[1] += a[2] * b[0] - a[0] * b[2]
    found[2] += a[0] * b[1] - a[1] * b[0]


@compiled
def _moved(frame, point, found):
    """Displace a point with a frame."""
    _turned(shifted(frame, MATRIX), point, found)
    for i in range(3):
        found[i] += frame[PLACE + i]


@compiled
def _exponential(screw, angle, p, place):
    """Store the displacement by a screw, as a quaternion and the position of the origin (Murray, Li and Sastry, eq. 2.36)."""
    v, w = screw, shifted(screw, 3)
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    p[0], p[1], p[2], p[3] = 1.0, 0.0, 0.0, 0.0
    for i in range(3):
        place[i] = v[i] * angle
    if square > 0.0:
        norm = sqrt(square)
        half = 0.5 * norm * angle
        p[0] = cos(half)
        for i in range(3):
            p[1 + i] = sin(half) * w[i] / norm
        arm, turned, m = room(3), room(3), room(9)
        arm[0], arm[1], arm[2] = 0.0, 0.0, 0.0
        _add_cross(w, v, arm)
        _matrix(p, m)
        _turned(m, arm, turned)
        along = (w[0] * v[0] + w[1] * v[1] + w[2] * v[2]) * angle
        for i in range(3):
            place[i] = (arm[i] - turned[i] + w[i] * along) / square


@compiled
def _place_screw(x, k, before, frame, angle, rate):
    """Displace a frame by a screw, and add its velocity."""
    screw = shifted(x.screw, 6 * k)
    p, place = room(4), room(3)
    _exponential(screw, angle, p, place)
    _times(before, p, frame)
    _moved(before, place, shifted(frame, PLACE))
    column = shifted(x.column, 6 * x.at_v[k])
    w = shifted(column, 3)
    _turned(shifted(before, MATRIX), shifted(screw, 3), w)
    _turned(shifted(before, MATRIX), screw, column)
    _add_cross(shifted(before, PLACE), w, column)
    velocity, after = shifted(before, VELOCITY), shifted(frame, VELOCITY)
    turning = room(6)
    for i in range(6):
        turning[i] = 0.0
    _add_cross(shifted(velocity, 3), column, turning)
    _add_cross(velocity, w, turning)
    _add_cross(shifted(velocity, 3), w, shifted(turning, 3))
    for i in range(6):
        after[i] = velocity[i] + rate * column[i]
        after[6 + i] = velocity[6 + i] + rate * turning[i]


@compiled
def _place_free(x, k, frame, q, v):
    """Place the frame of a free body: its coordinates are position and quaternion, its rates velocity and angular velocity in its axes."""
    reference = shifted(x.reference, 7 * k)
    back, own = room(4), room(9)
    back[0] = reference[3]
    for i in range(3):
        back[1 + i] = -reference[4 + i]
    _times(shifted(q, 3), back, frame)
    _matrix(frame, shifted(frame, MATRIX))
    place = shifted(frame, PLACE)
    _turned(shifted(frame, MATRIX), reference, place)
    for i in range(3):
        place[i] = q[i] - place[i]
    _matrix(shifted(q, 3), own)
    velocity = shifted(frame, VELOCITY)
    for i in range(12):
        velocity[i] = 0.0
    for j in range(3):
        linear, angular = shifted(x.column, 6 * (x.at_v[k] + j)), shifted(x.column, 6 * (x.at_v[k] + 3 + j))
        for i in range(6):
            linear[i] = 0.0
            angular[i] = 0.0
        linear[j] = 1.0
        for i in range(3):
            angular[3 + i] = own[3 * i + j]
        _add_cross(q, shifted(angular, 3), angular)
        for i in range(6):
            velocity[i] += v[j] * linear[i] + v[3 + j] * angular[i]
    _add_cross(v, shifted(velocity, 3), shifted(frame, RATE))


@compiled
def _place_frames(x, q, v):
    for k in range(x.n_frames):
        frame, before = shifted(x.frame, FRAME * (k + 1)), shifted(x.frame, FRAME * x.parent[k])
        if x.free[k]:
            _place_free(x, k, frame, shifted(q, x.at_q[k]), shifted(v, x.at_v[k]))
        else:
            _place_screw(x, k, before, frame, q[x.at_q[k]] - x.reference[7 * k], v[x.at_v[k]])
            _matrix(frame, shifted(frame, MATRIX))
            frame[ANGLE] = before[ANGLE] + x.screw[6 * k + 5] * (q[x.at_q[k]] - x.reference[7 * k])


@compiled
def _point_columns(x, b, place, own, n_v, rows):
    """Store the velocities of a point of a body by the rates, in ground axes, and the angular velocities in the given axes."""
    for at in range(x.path_start[b], x.path_start[b + 1]):
        k = x.path[at]
        column = shifted(x.column, 6 * k)
        point, w = room(3), room(3)
        for i in range(3):
            point[i] = column[i]
        _add_cross(shifted(column, 3), place, point)
        _turned_back(own, shifted(column, 3), w)
        for i in range(3):
            rows[i * n_v + k] = point[i]
            rows[(3 + i) * n_v + k] = w[i]


@compiled
def _point_motion(frame, place, own, velocity, rate):
    """Store the velocity of a point of a frame and its rate, then angular velocity and acceleration in the given axes."""
    v, a = shifted(frame, VELOCITY), shifted(frame, RATE)
    for i in range(3):
        velocity[i] = v[i]
        rate[i] = a[i]
    _add_cross(shifted(v, 3), place, velocity)
    _add_cross(shifted(a, 3), place, rate)
    _add_cross(shifted(v, 3), velocity, rate)
    _turned_back(own, shifted(v, 3), shifted(velocity, 3))
    _turned_back(own, shifted(a, 3), shifted(rate, 3))


@compiled
def _place_bodies(x, s):
    """Place the bodies, and store N, u and N' v."""
    own, place, p, both = room(9), room(3), room(4), room(12)
    for b in range(x.n_bodies):
        frame, reference = shifted(x.frame, FRAME * x.body_frame[b]), shifted(x.body_reference, BODY * b)
        _moved(frame, reference, place)
        _times(frame, shifted(reference, 3), p)
        _matrix(p, own)
        _point_motion(frame, place, own, both, shifted(both, 6))
        if s.spatial:
            for i in range(3):
                s.q[7 * b + i] = place[i]
            for i in range(4):
                s.q[7 * b + 3 + i] = p[i]
            for i in range(6):
                s.u[6 * b + i] = both[i]
                x.drift[6 * b + i] = both[6 + i]
            _point_columns(x, b, place, own, x.n_v, shifted(x.N, 6 * b * x.n_v))
        else:
            for i in range(2):
                s.q[3 * b + i] = place[i]
                s.u[3 * b + i] = both[i]
                x.drift[3 * b + i] = both[6 + i]
            s.q[3 * b + 2] = reference[7] + frame[ANGLE]
            s.u[3 * b + 2] = both[5]
            x.drift[3 * b + 2] = both[11]
            _planar_columns(x, b, place, shifted(x.N, 3 * b * x.n_v))


@compiled
def _planar_columns(x, b, place, rows):
    """Store the velocities and the angular velocity of a planar body by the rates."""
    for at in range(x.path_start[b], x.path_start[b + 1]):
        k = x.path[at]
        column = shifted(x.column, 6 * k)
        rows[k] = column[0] - column[5] * place[1]
        rows[x.n_v + k] = column[1] + column[5] * place[0]
        rows[2 * x.n_v + k] = column[5]


@compiled
def _take(x, s, q, v):
    """Take coordinates and rates of the tree, and place all bodies."""
    _place_frames(x, q, v)
    _place_bodies(x, s)
    for k in range(x.n_counters):
        s.q[x.counter[k]] = q[x.counter_from[k]]


@compiled
def _times_columns(x, width, count, source, row, column, values, found):
    """Store a matrix with the given entries times N."""
    for k in range(x.n_loops * x.n_v):
        found[k] = 0.0
    for k in range(count):
        b, value = column[k] // width, values[source[k]]
        to, of = shifted(found, row[k] * x.n_v), shifted(x.N, column[k] * x.n_v)
        for at in range(x.path_start[b], x.path_start[b + 1]):
            to[x.path[at]] += value * of[x.path[at]]


@compiled
def _add_inertia(x, s, width):
    """Store M = N^T M_u N for the diagonal of M_u, and add its other entries if there are any."""
    for k in range(x.n_v * x.n_v):
        x.M[k] = 0.0
    for row in range(s.n_u):
        b, of = row // width, shifted(x.N, row * x.n_v)
        for at in range(x.path_start[b], x.path_start[b + 1]):
            i = x.path[at]
            scaled, to = x.mass[row] * of[i], shifted(x.M, i * x.n_v)
            for other in range(x.path_start[b], at + 1):
                to[x.path[other]] += scaled * of[x.path[other]]
    for i in range(x.n_v):
        for j in range(i):
            total = x.M[i * x.n_v + j] + x.M[j * x.n_v + i]
            x.M[i * x.n_v + j] = total
            x.M[j * x.n_v + i] = total


@compiled
def _add_coupled_inertia(x, width, values):
    """Add the entries of the mass matrix of the bodies outside its diagonal."""
    for k in range(x.n_inertia):
        b, other, value = x.inertia_row[k] // width, x.inertia_column[k] // width, values[x.inertia_source[k]]
        of, by = shifted(x.N, x.inertia_row[k] * x.n_v), shifted(x.N, x.inertia_column[k] * x.n_v)
        for at in range(x.path_start[b], x.path_start[b + 1]):
            scaled, to = value * of[x.path[at]], shifted(x.M, x.path[at] * x.n_v)
            for another in range(x.path_start[other], x.path_start[other + 1]):
                to[x.path[another]] += scaled * by[x.path[another]]


@compiled
def _inertia_of(x, s, width, t):
    _add_inertia(x, s, width)
    if x.n_inertia:
        _add_coupled_inertia(x, width, evaluate(s, ACCELERATION, t))


def pose(t, q, v, tree):
    """Place all bodies."""
    x = joint_tree_view(tree)
    _take(x, state_view(x.state), q, v)


def inertia(t, q, v, tree):
    """Compute the mass matrix of the tree."""
    x = joint_tree_view(tree)
    s = state_view(x.state)
    _take(x, s, q, v)
    _inertia_of(x, s, s.n_u // x.n_bodies, t)


def closure(t, q, v, tree):
    """Compute the equations of the loops and their derivatives by the tree's rates."""
    x = joint_tree_view(tree)
    s = state_view(x.state)
    _take(x, s, q, v)
    values = evaluate(s, MOTION, t)
    for k in range(x.n_loops):
        x.C[k] = 0.0
    for k in range(x.n_c):
        x.C[x.c_row[k]] += values[x.c_source[k]]
    _times_columns(x, s.n_u // x.n_bodies, x.n_j, x.j_source, x.j_row, x.j_column, values, x.J)


def forces(t, q, v, tree):
    """Compute the mass matrix and the bias of the tree, and the accelerations of its loops."""
    x = joint_tree_view(tree)
    s = state_view(x.state)
    _take(x, s, q, v)
    width = s.n_u // x.n_bodies
    _add_inertia(x, s, width)
    values = evaluate(s, ACCELERATION, t)
    _add_coupled_inertia(x, width, values)
    for k in range(s.n_u):
        s.a[k] = x.mass[k] * x.drift[k]
    for k in range(x.n_inertia):
        s.a[x.inertia_row[k]] += values[x.inertia_source[k]] * x.drift[x.inertia_column[k]]
    for k in range(x.n_f):
        s.a[x.f_row[k]] -= values[x.f_source[k]]
    for k in range(x.n_v):
        x.h[k] = 0.0
    for row in range(s.n_u):
        b, of = row // width, shifted(x.N, row * x.n_v)
        for at in range(x.path_start[b], x.path_start[b + 1]):
            x.h[x.path[at]] += of[x.path[at]] * s.a[row]
    for k in range(x.n_loops):
        x.gamma[k] = 0.0
    for k in range(x.n_gamma):
        x.gamma[x.gamma_row[k]] += values[x.gamma_source[k]]
    for k in range(x.n_ja):
        x.gamma[x.ja_row[k]] -= values[x.ja_source[k]] * x.drift[x.ja_column[k]]
    _times_columns(x, width, x.n_ja, x.ja_source, x.ja_row, x.ja_column, values, x.J)


def marker(frame, path_body, point, tree, motion, columns):
    """Store position, rotation matrix and the bias of the velocities of a marker, and their derivatives by the rates.

    `frame`: frame of its body, `path_body`: its body, `point`: position, then rotation matrix by rows, at the reference pose.
    """
    x = joint_tree_view(tree)
    f = shifted(x.frame, FRAME * frame)
    both, ground = room(12), room(9)
    for i in range(9):
        ground[i] = 0.0
    ground[0], ground[4], ground[8] = 1.0, 1.0, 1.0
    _moved(f, point, motion)
    _point_motion(f, motion, ground, both, shifted(both, 6))
    for i in range(6):
        motion[12 + i] = both[6 + i]
    for row in range(3):
        for column in range(3):
            total = 0.0
            for i in range(3):
                total += f[MATRIX + 3 * row + i] * point[3 + 3 * i + column]
            motion[3 + 3 * row + column] = total
    _point_columns(x, path_body, motion, ground, x.n_v, columns)
