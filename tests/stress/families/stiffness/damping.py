"""Oscillators without damping, with too much of it, and with less than none, against their closed forms."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...simulation import simulation

STIFFNESS = 100.0


def oscillator(damping: float) -> Model:
    """1 kg on a rail, on a spring of 100 N/m with a damper, let go from 0.1 m."""
    model = Model("Oscillator")
    model.add("cart", Body(mass=1, inertia=1, position=(0.1, 0)))
    model.add("rail", JOINTS["prismatic"](i="cart", j="ground"))
    model.add("spring", FORCES["bushing"](i="cart", j="ground", stiffness=[STIFFNESS, 0, 0], damping=[damping, 0, 0]))
    return model


def _motion(t: np.ndarray, damping: float) -> np.ndarray:
    """x of x'' + c x' + k x = 0 from rest at 0.1 m; complex rates serve all dampings but the critical one."""
    root = np.sqrt(complex(damping**2 / 4 - STIFFNESS))
    fast = -damping / 2 - np.copysign(1, damping) * root if damping else root
    slow = STIFFNESS / fast  # the product of the rates; the difference would lose all digits
    return np.real(0.1 * (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (fast - slow))


def _error(solution: Solution, damping: float) -> float:
    expected = _motion(solution.t, damping)
    size = np.maximum.accumulate(np.maximum(np.abs(expected), 0.1))
    return float(np.max(np.abs(solution["cart.x"] - expected) / size))


def _energy(solution: Solution) -> float:
    return solution.energy_drift() / 0.5


def _case(damping: float):
    return simulation(
        f"damping {damping:g} N s/m",
        "1 kg on 100 N/m over 10 s; displacement against its closed form",
        partial(oscillator, damping), partial(_error, damping=damping), 1e-5, duration=10.0, points=101, rtol=1e-8,
    )  # fmt: skip


CASES = (
    *(_case(damping) for damping in (0.0, 0.02, 19.999, 2e3, 1e6, 1e9, 1e12, -0.02, -2.0, -21.0)),
    simulation(
        "no damping, 1000 oscillations: energy",
        "change of the energy relative to it",
        partial(oscillator, 0.0), _energy, 1e-3, duration=200 * np.pi, points=101, rtol=1e-8,
    ),
)  # fmt: skip
