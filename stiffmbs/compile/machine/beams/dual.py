"""Vectors and matrices of dual numbers a + eps b with eps^2 = 0, by which formulas for rotations hold for screws.

A screw is theta + eps u, with rotation theta and translation u. A wrench is n + eps m, with force n and moment m. The
dual part of their product is n.u + m.theta. Memory holds the real part before the dual part: two numbers, two vectors of
three, or two matrices of nine numbers by rows. Fischer, Dual-Number Methods in Kinematics, Statics and Dynamics (1999).
"""

from stiffmbs.compile.machine.native.access import compiled, shifted


@compiled
def set_number(a, real, dual):
    """Compute a = real + eps dual."""
    a[0], a[1] = real, dual


@compiled
def product(a, b, factor, c):
    """Compute c = factor a b."""
    real = factor * a[0] * b[0]
    c[1] = factor * (a[0] * b[1] + a[1] * b[0])
    c[0] = real


@compiled
def dot(a, b, c):
    """Compute c = a . b of vectors."""
    c[0], c[1] = 0.0, 0.0
    for i in range(3):
        c[0] += a[i] * b[i]
        c[1] += a[i] * b[3 + i] + a[3 + i] * b[i]


@compiled
def add_scaled(s, v, w):
    """Add s v to a vector w."""
    for i in range(3):
        w[3 + i] += s[0] * v[3 + i] + s[1] * v[i]
        w[i] += s[0] * v[i]


@compiled
def cross(a, b, c):
    """Compute c = a x b of vectors."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        c[i] = a[j] * b[k] - a[k] * b[j]
        c[3 + i] = a[j] * b[3 + k] + a[3 + j] * b[k] - a[k] * b[3 + j] - a[3 + k] * b[j]


@compiled
def add_outer(s, v, w, M):
    """Add s v w^T to a matrix M."""
    for i in range(3):
        real, dual = s[0] * v[i], s[0] * v[3 + i] + s[1] * v[i]
        for j in range(3):
            M[3 * i + j] += real * w[j]
            M[9 + 3 * i + j] += real * w[3 + j] + dual * w[j]


@compiled
def add_diagonal(s, M):
    """Add s times the identity to a matrix M."""
    for i in range(3):
        M[4 * i] += s[0]
        M[9 + 4 * i] += s[1]


@compiled
def add_cross(s, v, M):
    """Add s times the matrix of v x to a matrix M."""
    for part in range(2):
        to = shifted(M, 9 * part)
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            x = s[0] * v[3 * part + i]
            if part == 1:
                x += s[1] * v[i]
            to[3 * k + j] += x
            to[3 * j + k] -= x


@compiled
def of_screws(M, to):
    """Compute the 6x6 matrix, by rows, of a matrix from screws (theta, u) to screws."""
    for i in range(3):
        for j in range(3):
            real = M[3 * i + j]
            to[6 * i + j] = real
            to[6 * i + 3 + j] = 0.0
            to[6 * (3 + i) + j] = M[9 + 3 * i + j]
            to[6 * (3 + i) + 3 + j] = real


@compiled
def of_wrenches(M, sign, to):
    """Compute sign times the 6x6 matrix, by rows, of a matrix from screws (theta, u) to wrenches (m, n)."""
    for i in range(3):
        for j in range(3):
            real = sign * M[3 * i + j]
            to[6 * i + j] = sign * M[9 + 3 * i + j]
            to[6 * i + 3 + j] = real
            to[6 * (3 + i) + j] = real
            to[6 * (3 + i) + 3 + j] = 0.0
