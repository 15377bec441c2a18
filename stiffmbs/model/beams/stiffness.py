"""Stiffness of a beam element that is exact for small further deformations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, cast

import numpy as np

from .rigid_motion import adjoint, exponential, half_sine

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(5)


def element_stiffness(unloaded: np.ndarray, length: float, section: Callable[[float], np.ndarray]) -> np.ndarray:
    """Return K of an `exact_beam` of a length L, m, whose linear deformation is that of the continuous beam.

    The strain of an element under end loads is not constant. Its average depends on the loads by the compliance of the
    continuous beam, the integral of P(s) K(s)^-1 P(s)^T / L. P(s) is the relative displacement of the ends by a unit
    strain at s. For a straight beam this adds L^2/(12 EI) to 1/GA, the residual bending flexibility of MacNeal (1978).
    The nodes of a straight linear beam under nodal loads then have no discretisation error. Bending within a curved element
    is not counted as a stretch, a part L^4 kappa^2/(720 EI) of the compliance: a taut cable exhausts it at once.

    `unloaded` is (Gamma, kappa) without load, shape (6,); its first part is (1, 0, 0) for a tangent axis. `section`
    returns the stiffness of the section, shape (6, 6), at a fraction of the length.
    """
    bracket = adjoint(unloaded)
    symmetric = np.linalg.inv(half_sine(length * bracket))
    compliance = np.zeros((6, 6))
    for point, weight in zip(POINTS, WEIGHTS, strict=True):
        P = symmetric @ exponential(point * length / 2 * bracket)
        P[0, 3:] = 0.0  # bending and torsion do not stretch the element
        compliance += weight / 2 * P @ np.linalg.solve(section((1 + point) / 2), P.T)
    return inverse(compliance)


def inverse(compliance: np.ndarray) -> np.ndarray:
    """Return the stiffness of a compliance, with zeros in place of rounding."""
    found = np.linalg.inv(compliance)
    found = (found + found.T) / 2
    return cast(np.ndarray, np.where(np.abs(found) < 1e-13 * _scale(found), 0.0, found))


HERMITE: Final = 6 / 5
"""Geometric stiffness for the rotation of both ends of a slender element, per axial force and length: 1/5 + 1."""


def bowing(K: np.ndarray, section: np.ndarray, shear_centre: tuple[float, float]) -> np.ndarray:
    """Return the factors b of an `exact_beam` for the two shears of its shear centre.

    Without bowing, elements under a tension above 12 EI/L^2 would fold. The shear of a thick element is real, and does
    not stretch it: b is 6/5 times the square of the part of its compliance that stands for bending.

    `K`, `section`: stiffness of the element and of its cross section, shape (6, 6). `shear_centre`: from the centroid,
    along axes 2 and 3 of the element, m.
    """
    y, z = shear_centre
    shears = np.eye(6)[1:3]
    shears[:, 3] = -z, y
    compliance, of_shear = (np.diag(shears @ np.linalg.solve(each, shears.T)) for each in (K, section))
    bending = np.maximum(1 - of_shear / compliance, 0.0)
    return cast(np.ndarray, HERMITE * np.where(bending > 1e-6, bending, 0.0) ** 2)


def _scale(K: np.ndarray) -> np.ndarray:
    """Return the geometric mean of the diagonal entries of each row and column."""
    root = np.sqrt(np.diag(K))
    return np.outer(root, root)


def node_weights(elements: int) -> np.ndarray:
    """Return the weights of equidistant nodes in an integral, in lengths of an element; exact for cubics.

    Simpson's rules for two and three elements, Gregory's rule of fourth order from four on; the trapezoidal rule for a
    single element. All weights are positive, so they serve as lumped masses, and the mass, centre of mass and inertia of
    a straight uniform beam are exact.
    """
    if elements == 1:
        return np.array([0.5, 0.5])
    if elements == 2:
        return np.array([1.0, 4.0, 1.0]) / 3
    if elements == 3:
        return np.array([3.0, 9.0, 9.0, 3.0]) / 8
    weights = np.ones(elements + 1)
    for k, correction in enumerate((-5 / 8, 1 / 6, -1 / 24)):
        weights[k] += correction
        weights[-1 - k] += correction
    return weights
