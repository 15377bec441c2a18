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
def sum_of_mode(n, k, number, index, q, N):
    """Compute N_k = sum m r psi_k(q)^T, the derivative of sum m r r^T / 2 by a modal coordinate."""
    of_mode = mode_view(mode(number, k))
    for i in range(9):
        N[i] = of_mode.Y[i]
    for l in range(n):
        Z = pair_view(pair(n, number, l, k)).ZW
        y = q[coordinate(index, l)]
        for i in range(9):
            N[i] += y * Z[i]


@compiled
def coriolis(n, k, number, index, rate, x):
    """Compute sum m u' x psi_k from modal velocities."""
    for i in range(3):
        x[i] = 0.0
    for l in range(n):
        a = pair_view(pair(n, number, l, k)).axial
        y = rate[velocity(index, l)]
        for i in range(3):
            x[i] += y * a[i]


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
def first_moment_of_mode(n, k, number, index, q, D):
    """Compute D_k = S_k + sum T_kl q_l, the derivative of the first moment by a modal coordinate."""
    of_mode = mode_view(mode(number, k))
    for i in range(3):
        D[i] = of_mode.S[i]
    for l in range(n):
        T = pair_view(pair(n, number, l, k)).T
        y = q[coordinate(index, l)]
        for i in range(3):
            D[i] += y * T[i]


@compiled
def first_rate_of_mode(n, k, number, index, rate, s):
    """Compute sum T_kl rate_l of modal velocities or accelerations."""
    for i in range(3):
        s[i] = 0.0
    for l in range(n):
        T = pair_view(pair(n, number, l, k)).T
        y = rate[velocity(index, l)]
        for i in range(3):
            s[i] += y * T[i]


@compiled
def moment_rate_of_mode(n, k, number, index, rate, s):
    """Compute the axial vector of sum W_kl rate_l of modal velocities."""
    for i in range(3):
        s[i] = 0.0
    for l in range(n):
        of_pair = pair_view(pair(n, number, l, k))
        y = rate[velocity(index, l)]
        for i in range(3):
            s[i] += y * (axial(of_pair.ZW, i) - of_pair.axial[i])


@compiled
def first_moment(n, number, index, q, d):
    """Compute the first moment of mass d = d0 + sum S_k q_k + 1/2 sum T_kl q_k q_l."""
    b, D = body_view(number), room(3)
    for i in range(3):
        d[i] = b.d0[i]
    for k in range(n):
        of_mode = mode_view(mode(number, k))
        first_moment_of_mode(n, k, number, index, q, D)
        for i in range(3):
            d[i] += 0.5 * (of_mode.S[i] + D[i]) * q[coordinate(index, k)]


@compiled
def first_rate(n, number, index, q, rate, s):
    """Compute sum D_k rate_k of modal velocities or accelerations."""
    D = room(3)
    for i in range(3):
        s[i] = 0.0
    for k in range(n):
        first_moment_of_mode(n, k, number, index, q, D)
        for i in range(3):
            s[i] += D[i] * rate[velocity(index, k)]


@compiled
def second_moments(n, number, index, q, u, I, K):
    """Compute the inertia tensor without the moments of the frame, and K = sum m (x + u) u'^T."""
    b = body_view(number)
    N, J = room(9), room(9)
    for i in range(9):
        J[i] = b.X[i]
        K[i] = 0.0
    for k in range(n):
        sum_of_mode(n, k, number, index, q, N)
        of_mode = mode_view(mode(number, k))
        y, rate = q[coordinate(index, k)], u[velocity(index, k)]
        for i in range(3):
            for j in range(3):
                J[3 * i + j] += y * (of_mode.Y[3 * j + i] + N[3 * i + j])
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
