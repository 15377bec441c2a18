"""Multipliers far larger than weights: huge forces along a joint, and constraints that depend on each other but for little.

The relaxed constraints of SI2 creep under them, J u + C_t = E_lam lam; the motion is that of a pendulum all the same.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...mechanisms.pendulum import GRAVITY, bar_rate, swing
from ...simulation import simulation
from ..scales.long_runs import bar_pendulum

ROUNDING_GOVERNS = 1e-7
"""Slope up to which explicit steps follow rounding."""
ALLOWED = 3e-5
"""rad; 300 tolerances, as rounding of forces along the bar counts."""


def pulled(force: float) -> Model:
    """A pendulum whose bar is pulled along its length, N, which does nothing to its motion."""
    model = bar_pendulum()
    law = (f"{force!r} N * cos(bar.angle)", f"{force!r} N * sin(bar.angle)")
    model.add("pull", FORCES["force"](i="bar", j="ground", force=law))
    return model


def barely_held(slope: float) -> Model:
    """A pendulum whose end is held sideways by nothing but the slope with which a block that cannot rise would follow it."""
    model = Model("Barely held", gravity=(0, -GRAVITY))
    bar = model.add("bar", Body(mass=1, inertia=1 / 12, position=(0.5, 0)))
    model.add("block", Body(mass=1, inertia=1))
    model.add("rail", JOINTS["prismatic"](i="block", j="ground"))
    model.add("shelf", JOINTS["point_on_line"](i=bar.at(-0.5, 0), j="ground"))
    model.add("slope", JOINTS["equation"](zero=f"block.y - {slope!r}*(bar.x - 0.5*cos(bar.angle))"))
    return model


def nearly_repeated(slope: float) -> Model:
    """A pendulum on a pin, and an equation of its reach that holds a pushed block by a slope alone."""
    model = Model("Nearly repeated", gravity=(0, -GRAVITY))
    bar = model.add("bar", Body(mass=1, inertia=1 / 12, position=(0.5, 0)))
    model.add("block", Body(mass=1, inertia=1))
    model.add("rail", JOINTS["prismatic"](i="block", j="ground"))
    model.add("pin", JOINTS["revolute"](i=bar.at(-0.5, 0), j="ground"))
    model.add("reach", JOINTS["equation"](zero=f"bar.x^2 + bar.y^2 - 0.25 + {slope!r}*block.x"))
    model.add("push", FORCES["force"](i="block", j="ground", force=("2 N", "0 N")))
    return model


def swing_error(solution: Solution) -> float:
    """Largest error of the bar's angle against elliptic functions, rad."""
    expected = swing(solution.t, np.pi / 2, bar_rate(1.0))
    return float(np.max(np.abs(solution["bar.angle"] + np.pi / 2 - expected)))


CASES = (
    *(
        simulation(
            f"pendulum pulled by {force:.0e} N along its bar, {solver}", "angle against elliptic functions",
            partial(pulled, force), swing_error, ALLOWED, duration=2.0, points=101, rtol=1e-7, solver=solver,
        )
        for force in (1e4, 1e6, 1e8) for solver in ("bdf", "auto", "projected")
    ),
    *(
        simulation(
            f"pendulum held by a slope of {slope:.0e}, {solver}", "angle against elliptic functions",
            partial(barely_held, slope), swing_error, ALLOWED, duration=2.0, points=101, rtol=1e-7, solver=solver,
        )
        for slope in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6) for solver in ("bdf", "projected")
    ),
    *(
        simulation(
            f"block held by a slope of {slope:.0e} of an equation that its pendulum fulfils, {solver}", "angle against elliptic functions",
            partial(nearly_repeated, slope), swing_error, ALLOWED, duration=2.0, points=101, rtol=1e-7, solver=solver,
            expected=Outcome.TOLD if solver != "bdf" and slope <= ROUNDING_GOVERNS else Outcome.RIGHT,
        )
        for slope in (1e-5, 1e-6, 1e-7, 4e-8) for solver in ("bdf", "auto", "projected")
    ),
)  # fmt: skip
