"""Sums over the mass of a flexible body in a floating frame, from its modal coordinates.

A point x of the body is at r = t + A (x + u) with u = sum_k psi_k q_k + 1/2 sum_kl theta_kl q_k q_l. All terms are sums
over nodes with the mass matrix, contracted beforehand: d0 = sum m x, X = sum m x x^T, S_k = sum m psi_k,
Y_k = sum m x psi_k^T and Z_lk = sum m psi_l psi_k^T (Zwoelfer & Gerstmayr, Multibody System Dynamics 51, 2021), and of
second order T_lk = sum m theta_lk and W_lk = sum m x theta_lk^T. The kinetic energy is complete up to the first order in
theta; the modal mass is constant. Each is less the part of the rigid frame and of the unit modal masses, which the
diagonal of the mass matrix contains.

The layout of the numbers of a body is in `stiffmbs.elements.spatial.flexible.layout`. Vectors are in body axes, apart
from gravity. Matrices have nine entries by rows.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, parts_of, room, shifted
from stiffmbs.elements.spatial.flexible.layout import BODY, MODE, MODES, OF_MODE, OF_PAIR, PAIR

body_view = parts_of("FlexibleBody", BODY)
mode_view = parts_of("FlexibleMode", MODE)
pair_view = parts_of("FlexiblePair", PAIR)


@compiled
def mode(number, k):
    """Return the numbers of a mode."""
    return shifted(number, MODES + OF_MODE * k)


@compiled
def pair(n, number, l, k):
    """Return the numbers of a pair of modes."""
    return shifted(number, MODES + OF_MODE * n + OF_PAIR * (n * l + k))


@compiled
def coordinate(index, k):
    """Return the place of a modal coordinate in q: the modes follow three by three in bodies after the frame."""
    return int(index[2 + 2 * (k // 3)]) + k % 3


@compiled
def velocity(index, k):
    """Return the place of a modal velocity in u."""
    return int(index[3 + 2 * (k // 3)]) + k % 3


@compiled
def cross(a, b, c):
    """Compute c = a x b."""
    c[0] = a[1] * b[2] - a[2] * b[1]
    c[1] = a[2] * b[0] - a[0] * b[2]
    c[2] = a[0] * b[1] - a[1] * b[0]


@compiled
def times(M, x, y):
    """Compute y = M x."""
    for i in range(3):
        y[i] = M[3 * i] * x[0] + M[3 * i + 1] * x[1] + M[3 * i + 2] * x[2]


@compiled
def transposed_times(M, x, y):
    """Compute y = M^T x."""
    for i in range(3):
        y[i] = M[i] * x[0] + M[3 + i] * x[1] + M[6 + i] * x[2]


@compiled
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def axial(N, c):
    """Return entry c of sum m r x psi from sum m r psi^T."""
    if c == 0:
        return N[5] - N[7]
    if c == 1:
        return N[6] - N[2]
    return N[1] - N[3]


@compiled
def trace(N):
    """Return the trace of a matrix."""
    return N[0] + N[4] + N[8]


@compiled
def sums(n, work, which):
    """Return the sums over the first mode of all numbers of pairs, by the second mode: times modal coordinates (0),
    velocities (1) or accelerations (2)."""
    return shifted(work, 7 * n + 2 * n * n + OF_PAIR * n * which)


@compiled
def add_row(count, y, row, to):
    """Add y times some numbers to others."""
    for j in range(count):
        to[j] += y * row[j]


@compiled
def clear(count, to):
    """Set some numbers to zero."""
    for j in range(count):
        to[j] = 0.0


@compiled
def take_sums(n, number, index, q, u, work):
    """Compute the sums by modal coordinates and velocities."""
    of_q, of_u = sums(n, work, 0), sums(n, work, 1)
    clear(2 * OF_PAIR * n, of_q)
    for l in range(n):
        row = pair(n, number, l, 0)
        add_row(OF_PAIR * n, q[coordinate(index, l)], row, of_q)
        add_row(OF_PAIR * n, u[velocity(index, l)], row, of_u)


@compiled
def take_acceleration_sums(n, number, index, a, work):
    """Compute the sums by modal accelerations."""
    of_a = sums(n, work, 2)
    clear(OF_PAIR * n, of_a)
    for l in range(n):
        add_row(OF_PAIR * n, a[velocity(index, l)], pair(n, number, l, 0), of_a)


@compiled
def of_mode(s, k):
    """Return the numbers of a mode in the sums."""
    return shifted(s, OF_PAIR * k)


@compiled
def sum_of_mode(n, k, number, work, N):
    """Compute N_k = sum m r psi_k(q)^T, the derivative of sum m r r^T / 2 by a modal coordinate."""
    Y, Z = mode_view(mode(number, k)).Y, pair_view(of_mode(sums(n, work, 0), k)).ZW
    for i in range(9):
        N[i] = Y[i] + Z[i]


@compiled
def mode_with_rates(n, l, number, index, rate, P):
    """Compute the derivative of sum m r u'^T by a modal coordinate, from modal velocities or accelerations."""
    for i in range(9):
        P[i] = 0.0
    for k in range(n):
        Z = pair_view(pair(n, number, l, k)).ZW
        y = rate[velocity(index, k)]
        for i in range(9):
            P[i] += y * Z[i]


@compiled
def first_moment_of_mode(n, k, number, work, D):
    """Compute D_k = S_k + sum T_kl q_l, the derivative of the first moment by a modal coordinate."""
    S, T = mode_view(mode(number, k)).S, pair_view(of_mode(sums(n, work, 0), k)).T
    for i in range(3):
        D[i] = S[i] + T[i]


@compiled
def moment_rate_of_mode(n, k, work, s):
    """Compute the axial vector of sum W_kl rate_l of modal velocities."""
    rates = pair_view(of_mode(sums(n, work, 1), k))
    for i in range(3):
        s[i] = axial(rates.ZW, i) - rates.axial[i]


@compiled
def first_moment(n, number, index, q, work, d):
    """Compute the first moment of mass d = d0 + sum S_k q_k + 1/2 sum T_kl q_k q_l."""
    b, D = body_view(number), room(3)
    for i in range(3):
        d[i] = b.d0[i]
    for k in range(n):
        S = mode_view(mode(number, k)).S
        first_moment_of_mode(n, k, number, work, D)
        for i in range(3):
            d[i] += 0.5 * (S[i] + D[i]) * q[coordinate(index, k)]


@compiled
def first_rate(n, number, index, rate, work, s):
    """Compute sum D_k rate_k of modal velocities or accelerations."""
    D = room(3)
    for i in range(3):
        s[i] = 0.0
    for k in range(n):
        first_moment_of_mode(n, k, number, work, D)
        for i in range(3):
            s[i] += D[i] * rate[velocity(index, k)]


@compiled
def second_moments(n, number, index, q, u, work, I, K):
    """Compute the inertia tensor without the moments of the frame, and K = sum m (x + u) u'^T."""
    b = body_view(number)
    N, J = room(9), room(9)
    for i in range(9):
        J[i] = b.X[i]
        K[i] = 0.0
    for k in range(n):
        sum_of_mode(n, k, number, work, N)
        Y = mode_view(mode(number, k)).Y
        y, rate = q[coordinate(index, k)], u[velocity(index, k)]
        for i in range(3):
            for j in range(3):
                J[3 * i + j] += y * (Y[3 * j + i] + N[3 * i + j])
                K[3 * i + j] += rate * N[3 * i + j]
    for i in range(3):
        for j in range(3):
            I[3 * i + j] = -0.5 * (J[3 * i + j] + J[3 * j + i])
        I[4 * i] += trace(J) - b.moments[i]


@compiled
def moment_of_rotation(N, w, y):
    """Compute y = sum m r x (w x psi) = w tr N - N^T w from N = sum m r psi^T."""
    for i in range(3):
        y[i] = w[i] * trace(N) - (N[i] * w[0] + N[3 + i] * w[1] + N[6 + i] * w[2])


@compiled
def inertia_by_mode(N, w, y):
    """Compute the derivative of I w by a modal coordinate: 2 w tr N - (N + N^T) w."""
    for i in range(3):
        both = 0.0
        for j in range(3):
            both += (N[3 * i + j] + N[3 * j + i]) * w[j]
        y[i] = 2.0 * trace(N) * w[i] - both


@compiled
def centrifugal(N, w):
    """Return sum m psi . (w x (w x r)) with opposite sign: w . w tr N - w . N w."""
    total = 0.0
    for i in range(3):
        total += w[i] * w[i] * trace(N)
        for j in range(3):
            total -= w[i] * w[j] * N[3 * i + j]
    return total


@compiled
def rigid_momentum(w, d, s, y):
    """Compute y = w x d + s."""
    cross(w, d, y)
    for i in range(3):
        y[i] += s[i]
