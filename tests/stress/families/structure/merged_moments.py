"""Bodies with moments of no distribution of mass (`any_moments`) that presolve merges with others: Euler's equations hold."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from stiffmbs import spatial
from stiffmbs.analyses.run import run
from stiffmbs.elements.spatial.orientation import about, matrix, product

from ...variants.answers import compared

DURATION, ALLOWED = 0.5, 1e-6
SPIN = np.array([1.0, -2.0, 3.0])
"""Of all bodies at the start, in the axes of the first, rad/s."""
DISC = (5.0, 30.0, 90.0)
"""Moments of a body of no distribution of mass: 5 + 30 < 90."""


def error(bodies: int, odd: tuple[int, ...], chain: bool, seed: int, how: dict[str, Any]) -> float:
    """Return the error of the angular velocity of bodies that are fixed to each other and fly freely."""
    rng = np.random.default_rng(seed)
    turns = [product(about(0, 0.0), about(2, 0.0))] + [product(about(2, rng.uniform(-3, 3)), about(0, rng.uniform(-3, 3))) for _ in range(bodies - 1)]  # fmt: skip
    masses, places = rng.uniform(1, 3, bodies), np.vstack([np.zeros(3), rng.uniform(-1, 1, (bodies - 1, 3))])
    moments = [DISC if k in odd else tuple(rng.uniform(0.5, 0.9, 3)) for k in range(bodies)]
    centre = masses @ places / masses.sum()
    tensor = np.zeros((3, 3))
    model = spatial.Model("Merged", gravity=(0, 0, 0))
    for k, (mass, place, turn, principal) in enumerate(zip(masses, places, turns, moments, strict=True)):
        axes, arm = np.array(matrix(turn)), place - centre
        tensor += axes @ np.diag(principal) @ axes.T + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        body = spatial.Body(
            mass=mass, inertia=principal, any_moments=k in odd, position=tuple(place), orientation=turn,
            omega=tuple(axes.T @ SPIN), velocity=tuple(np.cross(SPIN, arm)),
        )  # fmt: skip
        model.add(f"b{k}", body)
        if k:
            to = k - 1 if chain else 0
            here, there = np.array(matrix(turns[to])), place - places[to]
            axes_there = here.T @ np.array(matrix(turn))
            j = spatial.Marker(
                body=f"b{to}",
                point=tuple(here.T @ there),
                orientation={"x": tuple(axes_there[:, 0]), "z": tuple(axes_there[:, 2])},
            )
            model.add(f"weld{k}", spatial.Fixed(i=f"b{k}", j=j))
    found = run(model, duration=DURATION, points=11, rtol=1e-9, **how)
    euler = solve_ivp(
        lambda t, w: np.linalg.solve(tensor, -np.cross(w, tensor @ w)), (0, DURATION), SPIN, t_eval=found.t, rtol=1e-11, atol=1e-12
    ).y  # fmt: skip
    return float(np.abs(np.array([found[f"b0.w{axis}"] for axis in "xyz"]) - euler).max())


VARIANTS: tuple[tuple[int, tuple[int, ...], bool, dict[str, Any]], ...] = (
    (2, (0,), True, {}), (2, (1,), True, {"solver": "bdf"}), (2, (0, 1), True, {"solver": "projected"}), (3, (0,), True, {"solver": "bdf"}),
    (3, (1,), False, {"solver": "projected"}), (3, (2,), True, {}), (3, (0, 2), False, {"solver": "bdf"}), (3, (0, 1, 2), True, {"solver": "projected"}),
    (4, (3,), False, {}), (4, (1, 2), True, {"solver": "bdf"}), (4, (0, 3), True, {"presolve": False, "solver": "bdf"}), (5, (2, 4), False, {"solver": "bdf"}),
)  # fmt: skip
"""Bodies, those with any moments, whether they form a chain, and settings."""

CASES = tuple(
    compared(f"{bodies} bodies in a {'chain' if chain else 'star'}, any moments of {odd}, {how}", "Euler's equations", partial(error, bodies, odd, chain, seed, how), ALLOWED)
    for seed, (bodies, odd, chain, how) in enumerate(VARIANTS)
)  # fmt: skip
