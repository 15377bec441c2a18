"""Planar Simo-Reissner beam by finite elements of high order, independent of the package.

    python -m tests.beams.high_order 16 6

prints the positions of both ends of the flying spaghetti in the plane over time, by 16 elements of order 6. x, y and the
angle of the section are interpolated by polynomials through Gauss-Lobatto points, with consistent mass and Gauss quadrature.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp


@dataclass
class Beam:
    """Straight beam of `count` elements of an order, and its numbers per length."""

    length: float
    EA: float
    GA: float
    EI: float
    mass: float
    inertia: float
    count: int
    order: int

    def __post_init__(self):
        p, size = self.order, self.length / self.count
        inner = legendre.legroots(legendre.legder(np.eye(p + 1)[p])).real
        local = np.array([-1.0, *np.sort(inner), 1.0])
        points, weights = legendre.leggauss(p + 2)
        inverse = np.linalg.inv(legendre.legvander(local, p))
        values = legendre.legvander(points, p) @ inverse
        slopes = np.stack([legendre.legval(points, legendre.legder(row)) for row in np.eye(p + 1)], axis=-1) @ inverse
        n, q = p * self.count + 1, len(points)
        self.s = np.zeros(n)
        self.N, self.D = np.zeros((q * self.count, n)), np.zeros((q * self.count, n))
        for k in range(self.count):
            rows, columns = slice(q * k, q * k + q), slice(p * k, p * k + p + 1)
            self.N[rows, columns], self.D[rows, columns] = values, slopes * 2 / size
            self.s[columns] = size * (k + (1 + local) / 2)
        self.w = np.tile(weights * size / 2, self.count)
        self.M = self.N.T @ (self.w[:, None] * self.N)

    def strain(self, q):
        """Return Gamma_1 and Gamma_2 and the curvature at the quadrature points, with cosine and sine."""
        x, y, a = q
        c, s = np.cos(self.N @ a), np.sin(self.N @ a)
        xs, ys = self.D @ x, self.D @ y
        return c * xs + s * ys - 1, c * ys - s * xs, self.D @ a, c, s

    def forces(self, q):
        """Return minus the derivatives of the strain energy by the nodal values, shape (3, n)."""
        g1, g2, k, c, s = self.strain(q)
        n1, n2 = self.w * self.EA * g1, self.w * self.GA * g2
        moment = n1 * g2 - n2 * (1 + g1)
        return -np.array(
            [self.D.T @ (c * n1 - s * n2), self.D.T @ (s * n1 + c * n2), self.N.T @ moment + self.D.T @ (self.w * self.EI * k)]
        )  # fmt: skip


def flying(count, order, rtol):
    """Yield t and the positions of both ends of the spaghetti in the plane (Simo, Vu-Quoc 1986)."""
    beam = Beam(10.0, 1e4, 1e4, 500.0, 1.0, 10.0, count, order)
    n = len(beam.s)
    inverse = np.linalg.inv(beam.M)
    q = np.array([6 - 0.6 * beam.s, 0.8 * beam.s, np.full(n, math.atan2(8, -6))])

    def rates(load):
        def of(t, z):
            f = beam.forces(z[: 3 * n].reshape(3, n))
            f[:, 0] += load
            return np.concatenate([z[3 * n :], (f @ inverse / np.array([[1.0], [1.0], [10.0]])).ravel()])

        return of

    z, times = np.concatenate([q.ravel(), np.zeros(3 * n)]), np.array([2, 2.5, 3, 4, 5, 6, 7, 8, 9, 10.0])
    for span, load in (((0, 2.5), np.array([8.0, 0, -80])), ((2.5, 10.0), np.zeros(3))):
        at = times[(times > span[0]) & (times <= span[1])]
        found = solve_ivp(rates(load), span, z, "DOP853", at, rtol=rtol, atol=rtol)
        z = found.y[:, -1]
        for t, ends in zip(found.t, found.y[[0, n, n - 1, 2 * n - 1]].T, strict=True):
            yield t, *ends


def main():
    """Print a table."""
    parser = argparse.ArgumentParser(description="Flying spaghetti in the plane by finite elements of high order.")
    parser.add_argument("count", type=int, help="number of elements")
    parser.add_argument("order", type=int)
    parser.add_argument("--rtol", type=float, default=1e-9)
    given = parser.parse_args()
    for row in flying(given.count, given.order, given.rtol):
        print(",".join(f"{x:.9g}" for x in row), flush=True)


if __name__ == "__main__":
    main()
