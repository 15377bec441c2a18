"""Sums over the mass of a flexible body in a floating frame, from its modal coordinates.

A point x of the body is at r = t + A (x + u) with u = sum_k psi_k q_k + 1/2 sum_kl theta_kl q_k q_l. All terms are sums
over nodes with the mass matrix, contracted beforehand: d0 = sum m x, X = sum m x x^T, S_k = sum m psi_k,
Y_k = sum m x psi_k^T and Z_lk = sum m psi_l psi_k^T (Zwoelfer & Gerstmayr, Multibody System Dynamics 51, 2021), and of
second order T_lk = sum m theta_lk and W_lk = sum m x theta_lk^T. The kinetic energy is complete up to the first order in
theta; the modal mass is constant. Each is less the part of the rigid frame and of the unit modal masses, which the
diagonal of the mass matrix contains.

The layout of the numbers of a body, and the components of matrices N = sum m r psi^T, are in
`stiffmbs.elements.spatial.flexible.layout`. Vectors are in body axes, apart from gravity. Other matrices have nine
entries by rows. Loops run over the modes of a row, so that the compiler uses SIMD instructions.

The array `work` has nine rows for elastic forces (`stiffmbs.compile.machine.flexible.elastic`), the modal
accelerations, and the vectors Gamma_i y and Gamma_i y'. Sums over the first mode of numbers of pairs follow. Those by
modal coordinates are N_k and D_k. Those by modal velocities are the rates of the axial vectors of N_k and Z, and of D_k.
Those by accelerations are of D_k. Last are the moments of `moments_view`.
"""

from typing import Final

from stiffmbs.compile.machine.native.access import compiled, parts_of, room, shifted
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.simd import add_products, plus_product, quad, spread, sum_of
from stiffmbs.compile.machine.native.vectors import clear, cross
from stiffmbs.elements.spatial.flexible.layout import (
    BODY,
    COUPLINGS,
    MODES,
    OF_MODE,
    OF_PAIR,
    PAIR,
    ROW_OF_MODE,
    ROW_OF_PAIR,
)

AXIAL, FIRST = ROW_OF_PAIR["axial"], ROW_OF_PAIR["T"]
"""First row of the axial vector of N and of D in the sums by modal coordinates, as in `MODE` and `PAIR`."""
BY_COORDINATE, BY_VELOCITY, BY_ACCELERATION = ROW_OF_PAIR["of_Z"], OF_PAIR - AXIAL, PAIR["T"]
"""Rows of the sums: of `PAIR` up to T, from the axial vector on, and of T."""
AXIAL_RATE: Final = 0
FIRST_RATE, AXIAL_RATE_OF_Z = FIRST - AXIAL, ROW_OF_PAIR["of_Z"] - AXIAL
"""First rows of the sums by modal velocities."""
ACCELERATIONS: Final = 9
"""Row of the modal accelerations."""
STIFFNESS, DAMPING = ROW_OF_MODE["stiffness"], ROW_OF_MODE["damping"]
"""Rows of a body's modes."""
body_view = parts_of("FlexibleBody", BODY)
moments_view = parts_of("Moments", {"d": 3, "rate": 3, "I": 9, "symmetric": 6, "axial": 3})
"""First moment d and its rate, the inertia tensor without the moments of the frame, and sum m (x + u) u'^T."""


@compiled
def width(n):
    """Return the length of a row."""
    return 4 * ((n + 3) // 4)


@compiled
def of_modes(n, number, row):
    """Return a row of numbers of modes."""
    return shifted(number, MODES + width(n) * row)


@compiled
def pairs(n, number, l):
    """Return the rows of pairs of mode l."""
    return shifted(number, MODES + width(n) * (OF_MODE + OF_PAIR * l))


@compiled
def modal_mass(n, number, l):
    """Return row l of the modal mass matrix, less its diagonal part."""
    return shifted(pairs(n, number, n), width(n) * l)


@compiled
def coupling(n, number, place, l):
    """Return row l of the coupling of modes by stiffness (place 0) or damping (place 1)."""
    return shifted(modal_mass(n, number, n), width(n) * (n * place + l))


@compiled
def shape(n, number, i):
    """Return b_i of the stretch of second order."""
    return shifted(coupling(n, number, COUPLINGS, 0), width(n) * i)


@compiled
def stretches(n, number, l):
    """Return the rows l of all Gamma_i."""
    known = int(body_view(number).known[0])
    return shifted(shape(n, number, known), width(n) * known * l)


@compiled
def coordinate(index, k):
    """Return the place of a modal coordinate in q: the modes follow three by three in bodies after the frame."""
    return int(index[2 + 2 * (k // 3)]) + k % 3


@compiled
def velocity(index, k):
    """Return the place of a modal velocity in u."""
    return int(index[3 + 2 * (k // 3)]) + k % 3


@compiled
def along(n, a, b):
    """Return the product of two rows."""
    total = spread(0.0)
    for k in range(0, n, 4):
        total = plus_product(total, quad(a, k), quad(b, k))
    return sum_of(total)


@compiled
def add_rows(x, rows, stride, count, to):
    """Add the products of three coordinates and rows of some numbers."""
    two, three, a, b, c = shifted(rows, stride), shifted(rows, 2 * stride), x[0], x[1], x[2]
    for j in range(count):
        to[j] = plus_product(plus_product(plus_product(to[j], a, rows[j]), b, two[j]), c, three[j])


@compiled
def combine(n, count, factors, step, rows, to):
    """Add a combination of consecutive rows to a row; the factors are `step` numbers apart."""
    for k in range(0, n, 4):
        add_products(1, 1, shifted(to, k), 0, factors, step, shifted(rows, k), width(n), count)


@compiled
def column(n, count, rows, k, to):
    """Copy the numbers of mode k from consecutive rows."""
    for i in range(count):
        to[i] = rows[width(n) * i + k]


@compiled
def elastic(n, work, row):
    """Return a row for elastic forces, or of accelerations."""
    return shifted(work, width(n) * row)


@compiled
def stretched(n, work, i):
    """Return Gamma_i y, or from i = n on Gamma_i y'."""
    return elastic(n, work, ACCELERATIONS + 1 + i)


@compiled
def by_coordinates(n, work, row):
    """Return a row of the sums by modal coordinates."""
    return stretched(n, work, 2 * n + row)


@compiled
def by_velocities(n, work, row):
    """Return a row of the sums by modal velocities."""
    return by_coordinates(n, work, BY_COORDINATE + row)


@compiled
def by_accelerations(n, work):
    """Return the rows of the sums by modal accelerations."""
    return by_velocities(n, work, BY_VELOCITY)


@compiled
def moments(n, work):
    """Return the moments of mass."""
    return shifted(by_accelerations(n, work), width(n) * BY_ACCELERATION)


@compiled
def take_sums(n, number, index, q, u, work):
    """Compute the sums by modal coordinates and velocities, and the moments."""
    y, rate, row = elastic(n, work, 0), elastic(n, work, 1), width(n)
    clear(2 * row, y)
    for k in range(n):
        y[k] = q[coordinate(index, k)]
        rate[k] = u[velocity(index, k)]
    of_q, of_u = by_coordinates(n, work, 0), by_velocities(n, work, 0)
    copied(of_q, of_modes(n, number, 0), BY_COORDINATE * row)
    clear(BY_VELOCITY * row, of_u)
    for l in range(0, n, 3):
        rows = pairs(n, number, l)
        add_rows(shifted(y, l), rows, OF_PAIR * row, BY_COORDINATE * row, of_q)
        add_rows(shifted(rate, l), shifted(rows, AXIAL * row), OF_PAIR * row, BY_VELOCITY * row, of_u)
    take_moments(n, number, work)


@compiled
def take_moments(n, number, work):
    """Compute the moments of mass from the sums."""
    y, rate, b, m, J = (
        elastic(n, work, 0),
        elastic(n, work, 1),
        body_view(number),
        moments_view(moments(n, work)),
        room(6),
    )
    for i in range(3):
        D, N = by_coordinates(n, work, FIRST + i), by_coordinates(n, work, AXIAL + i)
        m.d[i] = b.d0[i] + 0.5 * (along(n, of_modes(n, number, FIRST + i), y) + along(n, D, y))
        m.rate[i] = along(n, D, rate)
        m.axial[i] = along(n, N, rate)
    for i in range(6):
        N = by_coordinates(n, work, i)
        J[i] = b.X[i] + along(n, of_modes(n, number, i), y) + along(n, N, y)
        m.symmetric[i] = along(n, N, rate)
    I = m.I
    I[0], I[4], I[8] = J[1] + J[2] - b.moments[0], J[0] + J[2] - b.moments[1], J[0] + J[1] - b.moments[2]
    I[1], I[2], I[5] = -0.5 * J[5], -0.5 * J[4], -0.5 * J[3]
    I[3], I[6], I[7] = I[1], I[2], I[5]


@compiled
def take_acceleration_sums(n, number, index, a, work):
    """Compute the sums by modal accelerations, and the accelerations as a row."""
    rates, of_a, row = elastic(n, work, ACCELERATIONS), by_accelerations(n, work), width(n)
    clear(row, rates)
    for k in range(n):
        rates[k] = a[velocity(index, k)]
    clear(BY_ACCELERATION * row, of_a)
    for l in range(0, n, 3):
        rows = shifted(pairs(n, number, l), FIRST * row)
        add_rows(shifted(rates, l), rows, OF_PAIR * row, BY_ACCELERATION * row, of_a)


@compiled
def moment_of_rotation(N, w, y):
    """Compute y = sum m r x (w x psi) = w tr N - N^T w from the components of N = sum m r psi^T."""
    cross(w, shifted(N, AXIAL), y)
    y[0] = 0.5 * (y[0] + 2.0 * (N[1] + N[2]) * w[0] - N[5] * w[1] - N[4] * w[2])
    y[1] = 0.5 * (y[1] + 2.0 * (N[0] + N[2]) * w[1] - N[5] * w[0] - N[3] * w[2])
    y[2] = 0.5 * (y[2] + 2.0 * (N[0] + N[1]) * w[2] - N[4] * w[0] - N[3] * w[1])


@compiled
def inertia_by_mode(N, w, y):
    """Compute the derivative of I w by a modal coordinate: 2 w tr N - (N + N^T) w."""
    y[0] = 2.0 * (N[1] + N[2]) * w[0] - N[5] * w[1] - N[4] * w[2]
    y[1] = 2.0 * (N[0] + N[2]) * w[1] - N[5] * w[0] - N[3] * w[2]
    y[2] = 2.0 * (N[0] + N[1]) * w[2] - N[4] * w[0] - N[3] * w[1]


@compiled
def centrifugal(w, c):
    """Compute the factors of the symmetric part of N in sum m psi . (w x (w x r)) with opposite sign."""
    c[0], c[1], c[2] = w[1] * w[1] + w[2] * w[2], w[0] * w[0] + w[2] * w[2], w[0] * w[0] + w[1] * w[1]
    c[3], c[4], c[5] = -w[1] * w[2], -w[2] * w[0], -w[0] * w[1]


@compiled
def rigid_momentum(w, d, s, y):
    """Compute y = w x d + s."""
    cross(w, d, y)
    for i in range(3):
        y[i] += s[i]
