"""Starts in and near singular poses, and runs through them, on the branch that the inertia of the links chooses."""

from __future__ import annotations

from functools import partial

from ...case import Outcome
from ...mechanisms.parallelogram import parallelogram, swing_error
from ...simulation import refusal, simulation

DISTANCES = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
NEAREST = 1e-7
"""Nearer to flat than that, rad, a start is refused as singular."""


CASES = (
    refusal("start in a flat parallelogram", "neither branch is preferred", partial(parallelogram, angle=0.0), ("singular", "crank0")),
    *(
        simulation(
            f"start {distance:.0e} rad from flat, {solver}", "cranks' angle against elliptic functions",
            partial(parallelogram, angle=-distance), swing_error, 1e-4, names=("singular", "crank0"),
            expected=Outcome.TOLD if distance < NEAREST else Outcome.RIGHT,
            duration=0.6, points=61, rtol=1e-8, solver=solver,
        )
        for distance in DISTANCES for solver in ("bdf", "projected")
    ),
    *(
        simulation(
            f"turning through flat poses at {omega:g} rad/s, {solver}", "cranks' angle against elliptic functions",
            partial(parallelogram, omega=omega), swing_error, 1e-3, names=(),
            duration=3.0, points=301, rtol=1e-8, solver=solver,
        )
        for omega in (9.0, 30.0) for solver in ("bdf", "projected")
    ),
)  # fmt: skip
