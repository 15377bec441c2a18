"""Compare the reported stability of random equilibria with runs from a perturbed state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stiffmbs.analyses.equilibrium import EquilibriumFound, equilibrium
from stiffmbs.analyses.job import Runnable
from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.analyses.run import run
from stiffmbs.elements.planar_kinds import FORCES
from stiffmbs.elements.spatial.spatial_kinds import FORCES as SPATIAL_FORCES
from stiffmbs.errors import StiffmbsError
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict
from ..random_statics import random_statics

WHAT = "Equilibria with negative or positive damping: reported stability against runs from perturbed states."
PUSH, DURATION, LARGEST = 1e-6, 4.0, 12.0
"""Initial velocity, m/s; duration of a run, s, and growth exponent at which it ends sooner, while disturbances are small."""
TOLERANCES = 1e-9, 1e-12
"""Of a first run, and of a second one where that disagrees: an integrator damps vibrations below its tolerance."""
EXPONENT, CLEAR = 6.0, 10.0
"""Growth exponent of a run that is significant, and factor by which an unstable motion grows."""
BEATS = 1e3
"""Transient growth of a stable motion."""
ROUNDING = float(np.finfo(float).eps)
"""Velocity relative to the push that a body which is held has by rounding."""


def trial(seed: int) -> Verdict:
    """Test one mechanism with springs, and a force along the velocity of one of its bodies."""
    rng, in_space = np.random.default_rng(seed), seed % 2 == 1
    model = random_statics(rng, in_space)
    body, gain = str(rng.choice(list(model.bodies))), float(rng.uniform(-15, 15))
    law = [f"{gain!r}*{body}.vx", *[0.0] * (2 if in_space else 1)]
    model.add("along", (SPATIAL_FORCES if in_space else FORCES)["force"](i=body, force=law))
    try:
        found = equilibrium(model)
        growth = max(
            (v.real for mode in modes(model, start_from=found.solution).modes for v in mode.eigenvalues), default=0.0
        )
        for rtol in TOLERANCES:
            verdict = _judged(model, found, growth, rtol)
            if verdict.outcome is not Outcome.WRONG:
                break
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=str(refusal))
    return verdict


def _judged(model: Runnable, found: EquilibriumFound, growth: float, rtol: float) -> Verdict:
    """Compare the growth of a run from a perturbed equilibrium with that of its fastest mode, 1/s."""
    rest, duration = found.solution.state(), min(DURATION, LARGEST / max(growth, LARGEST / DURATION))
    pushed = {name: value + PUSH * (name.endswith(".vx")) for name, value in rest.channels.items()}
    solution = run(model, start_from=replace(rest, channels=pushed), duration=duration, rtol=rtol, points=201)
    told = any("unstable" in note for note in found.notes)
    if solution.outcome is not Ending.DONE:
        return Verdict(Outcome.TOLD, detail=solution.message)
    moves = np.max([np.abs(solution[name]) for name in solution if name.endswith((".vx", ".vy", ".vz"))], axis=0)
    factor = float(moves[-20:].max() / max(float(moves[:20].max()), ROUNDING * PUSH))
    detail = f"a motion grows by {factor:.3g}, the fastest mode at {growth:.3g} 1/s: {found.notes}"
    missed = not told and factor > BEATS
    false = told and growth * duration > EXPONENT and factor < CLEAR
    return Verdict(Outcome.WRONG if missed or false else Outcome.RIGHT, factor, BEATS, detail)
