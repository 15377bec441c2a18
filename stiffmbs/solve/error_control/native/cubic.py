"""Distance of the states after some steps from a cubic, and the third derivative of the cubic."""

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted


@compiled
def _polynomials(count, x, p, squares):
    """Compute monic orthogonal polynomials of degree 0 to 3 at the points x, and their sums of squares."""
    for degree in range(4):
        here, before, older = (
            shifted(p, degree * count),
            shifted(p, (degree - 1) * count),
            shifted(p, (degree - 2) * count),
        )
        centre = 0.0
        for i in range(count if degree > 0 else 0):
            centre += x[i] * before[i] * before[i]
        squares[degree] = 0.0
        for i in range(count):
            here[i] = 1.0
            if degree > 0:
                here[i] = (x[i] - centre / squares[degree - 1]) * before[i]
            if degree > 1:
                here[i] -= squares[degree - 1] / squares[degree - 2] * older[i]
            squares[degree] += here[i] * here[i]


def cubic(count, n, rows, rtol, atol, work, found):
    """Compare `count` rows, a time and n values each, with the best-fitting cubics, in units of the tolerance.

    `found` receives two numbers: the largest RMS distance of any row, and the RMS of the cubic coefficients, with times
    scaled to -1 to 1.  `work` has space for n + 6 count + 8 numbers.
    """
    scale, x, p = work, shifted(work, n), shifted(work, n + count)
    off, squares, part = shifted(work, n + 5 * count), shifted(work, n + 6 * count), shifted(work, n + 6 * count + 4)
    first, last = rows[0], rows[(count - 1) * (n + 1)]
    for i in range(count):
        x[i] = (2.0 * rows[i * (n + 1)] - first - last) / (last - first)
    for k in range(n):
        scale[k] = rtol * abs(rows[(count - 1) * (n + 1) + 1 + k]) + atol[k]
    _polynomials(count, x, p, squares)
    for i in range(count):
        off[i] = 0.0
    highest = 0.0
    for k in range(n):
        for degree in range(4):
            part[degree] = 0.0
            for i in range(count):
                part[degree] += p[degree * count + i] * rows[i * (n + 1) + 1 + k]
            part[degree] /= squares[degree]
        highest += (part[3] / scale[k]) * (part[3] / scale[k])
        for i in range(count):
            error = rows[i * (n + 1) + 1 + k]
            for degree in range(4):
                error -= part[degree] * p[degree * count + i]
            off[i] += (error / scale[k]) * (error / scale[k])
    largest = 0.0
    for i in range(count):
        largest = max(largest, off[i])
    found[0] = sqrt(largest / n)
    found[1] = sqrt(highest / n)
