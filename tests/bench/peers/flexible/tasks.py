"""Flexible bodies that hang from the ground and move under their weight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stiffmbs.flexible_bodies.finite_elements import FiniteElements


@dataclass(frozen=True)
class HungBeam:
    """A round beam along x from the origin, held at its start, which falls from rest; its end is compared.

    Attributes
    ----------
    diameter, modulus : float
        m and N/m^2; the length is 1 m, the density 1100 kg/m^3 and Poisson's ratio 0.3.
    clamped : bool
        Whether the start is clamped, in place of a hinge.
    times : ndarray
        Output times, evenly spaced from zero.
    """

    diameter: float
    modulus: float
    clamped: bool
    times: np.ndarray

    @property
    def stiffness(self) -> tuple[float, float, float]:
        """EA, GA with Cowper's shear factor, and EI."""
        nu, area = 0.3, np.pi * self.diameter**2 / 4
        shear = 6 * (1 + nu) / (7 + 6 * nu) / (2 * (1 + nu))
        return self.modulus * area, shear * self.modulus * area, self.modulus * np.pi * self.diameter**4 / 64

    @property
    def mass(self) -> tuple[float, float]:
        """Mass and rotary inertia per length."""
        return 1100 * np.pi * self.diameter**2 / 4, 1100 * np.pi * self.diameter**4 / 64


@dataclass(frozen=True)
class HungBody:
    """A reduced finite element model with a hinge about y at the nodes of its start, which falls; its end is compared.

    Attributes
    ----------
    model : FiniteElements
    modes : ndarray, shape (3 nodes, n)
        In its mean-axes frame.
    ends : tuple of ndarray of int
        Nodes of the start and of the end.
    damping : float
        Stiffness-proportional, s.
    times : ndarray
    """

    model: FiniteElements
    modes: np.ndarray
    ends: tuple[np.ndarray, np.ndarray]
    damping: float
    times: np.ndarray


GRAVITY = 9.81
