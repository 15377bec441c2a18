"""Nodes of a beam: their markers, and the screws from the reference node to the others.

With H = H_m^-1 H_k from the reference m to node k, xi = log H and twists y in the axes of the markers, xi' = P y_k + Q y_m
with P = T(xi)^-1 and Q = -T(-xi)^-1. Twists are (omega, v), and wrenches (m, n). A planar model fills the same arrays.
"""

from math import cos, sqrt

from stiffmbs.compile.machine.beams.dual import of_screws
from stiffmbs.compile.machine.beams.screws import of_inverse, square, tangent
from stiffmbs.compile.machine.native.access import compiled, parts_of, room, shifted
from stiffmbs.compile.machine.native.rotation_vector import rotation_vector
from stiffmbs.compile.machine.native.vectors import clear, cross, times, transposed_times
from stiffmbs.elements.forces.beam_layout import NODE, OF_NODE

node_view = parts_of("BeamNode", NODE)


@compiled
def node(nodes, k):
    """Return the values of a node."""
    return shifted(nodes, OF_NODE * k)


@compiled
def place_in_plane(placed, q, turn, u, to):
    """Compute the values of a node from its marker's point, angle, cosine and sine, and its body's q, turn and u."""
    of = node_view(to)
    clear(OF_NODE, to)
    c, s = turn[0], turn[1]
    of.R[0], of.R[1], of.R[3], of.R[4], of.R[8] = c, -s, s, c, 1.0
    c, s = placed[3], placed[4]
    of.C[0], of.C[1], of.C[3], of.C[4], of.C[8] = c, -s, s, c, 1.0
    of.point[0], of.point[1] = placed[0], placed[1]
    of.origin[0], of.origin[1] = q[0], q[1]
    of.turned[0] = q[2] + placed[2]
    of.v[0], of.v[1], of.w[2] = u[0], u[1], u[2]
    finish(to)


@compiled
def place_in_space(placed, q, turn, u, to):
    """Compute the values of a node from its marker's point, matrix and quaternion, and its body's q, turn and u."""
    of = node_view(to)
    clear(OF_NODE, to)
    for i in range(9):
        of.R[i] = turn[i]
        of.C[i] = placed[3 + i]
    for i in range(3):
        of.point[i] = placed[i]
        of.origin[i] = q[i]
        of.v[i] = u[i]
        of.w[i] = u[3 + i]
    for i in range(4):
        of.e[i] = turn[9 + i]
    size = 1.0 / sqrt(q[3] * q[3] + q[4] * q[4] + q[5] * q[5] + q[6] * q[6])
    own = shifted(placed, 12)
    of.turned[0] = size * (q[3] * own[0] - q[4] * own[1] - q[5] * own[2] - q[6] * own[3])
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        x = q[3] * own[1 + i] + own[0] * q[4 + i] + q[4 + j] * own[1 + k] - q[4 + k] * own[1 + j]
        of.turned[1 + i] = size * x
    finish(to)


@compiled
def finish(to):
    """Compute the marker's axes, point and twist."""
    of = node_view(to)
    x = room(3)
    for i in range(3):
        for j in range(3):
            of.A[3 * i + j] = of.R[3 * i] * of.C[j] + of.R[3 * i + 1] * of.C[3 + j] + of.R[3 * i + 2] * of.C[6 + j]
    times(of.R, of.point, x)
    for i in range(3):
        of.origin[i] += x[i]
    transposed_times(of.R, of.v, of.carried)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        x[i] = of.carried[i] + of.w[j] * of.point[k] - of.w[k] * of.point[j]
    transposed_times(of.C, of.w, of.twist)
    transposed_times(of.C, x, shifted(of.twist, 3))


@compiled
def relative_screw(space, orders, reference, to):
    """Compute the screw of a node from the reference, P, Q, and the margin to a rotation of 270 degrees."""
    of = node_view(to)
    m = node_view(reference)
    d, x, y = room(3), room(3), room(3)
    if space == 1:
        h = 0.0
        for i in range(4):
            h += m.turned[i] * of.turned[i]
        factor = rotation_vector(h, 0)
        for i in range(3):
            j, k = 1 + (i + 1) % 3, 1 + (i + 2) % 3
            part = m.turned[0] * of.turned[1 + i] - of.turned[0] * m.turned[1 + i]
            of.screw[i] = factor * (part - m.turned[j] * of.turned[k] + m.turned[k] * of.turned[j])
        of.margin[0] = h + sqrt(0.5)
    else:
        of.screw[2] = of.turned[0] - m.turned[0]
        of.margin[0] = cos(0.5 * of.screw[2]) + sqrt(0.5)
    for i in range(3):
        x[i] = of.origin[i] - m.origin[i]
    transposed_times(m.A, x, d)
    of_inverse(square(of.screw), orders, of.inverse)
    # u = d - theta x d/2 + e theta x (theta x d) of the displacement d
    cross(of.screw, d, x)
    cross(of.screw, x, y)
    for i in range(3):
        of.screw[3 + i] = d[i] - 0.5 * x[i] + of.inverse[0] * y[i]


@compiled
def relative_tangents(to):
    """Compute P and Q of a node."""
    of = node_view(to)
    M, half = room(18), room(2)
    half[0], half[1] = -0.5, 0.0
    tangent(of.screw, half, 1.0, of.inverse, M)
    of_screws(M, of.P)
    tangent(of.screw, half, -1.0, of.inverse, M)
    of_screws(M, of.Q)
    for i in range(36):
        of.Q[i] = -of.Q[i]
