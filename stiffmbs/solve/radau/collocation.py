"""Coefficients of the Radau IIA collocation methods.

Hairer and Wanner, Solving Ordinary Differential Equations II (2nd ed. 1996), ch. IV.5 and IV.8; Stiff differential
equations solved by Radau methods, J. Comput. Appl. Math. 111 (1999) 93-111.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import Legendre, Polynomial

MOST_BETWEEN = 4
"""Largest number of corrections of a polynomial between the nodes."""


@dataclass(frozen=True, eq=False)
class Collocation:
    """Radau IIA method of s stages, of order 2 s - 1.

    The polynomial through y_n and the stages Y_i = y_n + Z_i satisfies the equations at all nodes; its derivative there
    is (1/h) sum_j D_ij Z_j with D = A^-1.

    - `nodes` of shape (s,): c_i; the last is 1.
    - `derivative` of shape (s, s): D.
    - `transform`, `inverse` of shape (s, s): T and T^-1, with T^-1 D T = diag(gamma, blocks [[alpha, -beta], [beta,
      alpha]]).
    - `gamma`; `alpha`, `beta` of shape ((s - 1) / 2,): eigenvalues of D.
    - `error` of shape (s,): d with y_hat - y = (gamma/h M - f_y)^-1 (f(y_n) + M sum_i d_i Z_i / h), a difference of
      order s.
    - `between` of shape (s + 3,): places at which corrections of the polynomial are interpolated: the nodes within the
      step, then the best others.
    - `weights` of shape (s + 1,): barycentric weights of the nodes 0, c_1 to c_s.
    - `bubble` of shape (s + 2,): coefficients of the polynomial, zero at 0 and 1, by which the error estimate corrects
      the solution within the step.  The polynomial of the stages has the defect f(y_n) - u'(0) = K prod_i (-c_i) at 0,
      hence K prod_i (x - c_i) within the step up to the next order, whose integral is the correction.
    - `most_between`: largest correction of the solution between the nodes, for a defect f(y_n) - u'(0) of 1.
    """

    nodes: np.ndarray
    derivative: np.ndarray
    transform: np.ndarray
    inverse: np.ndarray
    gamma: float
    alpha: np.ndarray
    beta: np.ndarray
    error: np.ndarray
    weights: np.ndarray
    bubble: np.ndarray
    between: np.ndarray
    most_between: float

    @property
    def stages(self) -> int:
        """Return the number of stages."""
        return len(self.nodes)


@cache
def radau(stages: int) -> Collocation:
    """Return the coefficients of the method with an odd number of stages."""
    nodes = _nodes(stages)
    points = np.concatenate([[0.0], nodes])
    weights = _barycentric(points)
    derivative = _differentiation(points, weights)[1:, 1:]
    transform, gamma, alpha, beta = _real_form(derivative)
    at_start = _barycentric(nodes) * np.prod(-nodes) / -nodes
    error, inverse = -derivative.T @ at_start, np.linalg.inv(transform)
    correction = Polynomial.fromroots(nodes).integ() / np.prod(-nodes)
    most = float(np.abs(correction(nodes)).max())  # its extrema are the nodes
    return Collocation(
        nodes, derivative, transform, inverse, gamma, alpha, beta, error, weights, gamma * correction.coef, _between(points), most
    )  # fmt: skip


def _between(points: np.ndarray) -> np.ndarray:
    """Return places in which the product of the distances from all earlier points and places is largest (Leja points)."""
    places = np.linspace(0.0, 1.0, 2001)
    for _ in range(MOST_BETWEEN):
        distances = np.abs(places[:, None] - points).prod(axis=1)
        points = np.append(points, places[distances.argmax()])
    return np.concatenate([points[1 : -MOST_BETWEEN - 1], points[-MOST_BETWEEN:]])


def _nodes(stages: int) -> np.ndarray:
    """Return the roots of P_s - P_(s-1), Legendre polynomials of 2 x - 1, refined by Newton's method."""
    polynomial = Legendre.basis(stages) - Legendre.basis(stages - 1)
    x = np.sort(polynomial.roots().real)
    slope = polynomial.deriv()
    for _ in range(3):
        x = x - polynomial(x) / slope(x)
    x[-1] = 1.0
    nodes: np.ndarray = (x + 1.0) / 2.0
    return nodes


def _barycentric(points: np.ndarray) -> np.ndarray:
    apart = points[:, None] - points
    np.fill_diagonal(apart, 1.0)
    weights: np.ndarray = 1.0 / apart.prod(axis=1)
    return weights


def _differentiation(points: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the derivatives of the Lagrange polynomials at the points, one polynomial in each column."""
    apart = points[:, None] - points
    np.fill_diagonal(apart, 1.0)
    matrix = weights / weights[:, None] / apart
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    found: np.ndarray = matrix
    return found


def _real_form(derivative: np.ndarray) -> tuple[np.ndarray, float, np.ndarray, np.ndarray]:
    """Return T, gamma, alpha and beta of the real block diagonal form; complex pairs by increasing beta."""
    values, vectors = np.linalg.eig(derivative)
    real = int(np.abs(values.imag).argmin())
    above = sorted(np.flatnonzero(values.imag > 1e-6).tolist(), key=lambda k: float(values[k].imag))
    columns = [vectors[:, real].real]
    for k in above:
        columns += [vectors[:, k].real, -vectors[:, k].imag]
    transform = np.stack(columns, axis=1)
    return transform, float(values[real].real), values[above].real.copy(), values[above].imag.copy()
