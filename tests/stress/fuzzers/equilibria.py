"""Random equilibria: found, balanced, at rest in a run, and stable unless it is said otherwise."""

from __future__ import annotations

import numpy as np

from stiffmbs.analyses.equilibrium import EquilibriumFound, equilibrium
from stiffmbs.analyses.job import Runnable
from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.results.solution import Solution

from ..case import Outcome, Verdict, measured
from ..random_statics import random_statics

WHAT = "mechanisms with springs, bushings, contacts and closed loops: their equilibrium, and whether a run stays there"
DURATION, RTOL = 1.0, 1e-9
STILL = 1e-6
"""Largest motion in a run from there, m or rad; and acceleration relative to gravity's."""
GROWTH = 1e-3
"""Growth of a mode, 1/s, that tells an unstable equilibrium."""
POSES = (".x", ".y", ".z", ".angle", ".q0", ".q1", ".q2", ".q3")
ACCELERATIONS = (".ax", ".ay", ".az", ".alpha", ".wdx", ".wdy", ".wdz")


def trial(seed: int) -> Verdict:
    """Make a mechanism, in the plane for even seeds, and seek its equilibrium; there is one."""
    model = random_statics(np.random.default_rng(seed), in_space=seed % 2 == 1)
    try:
        found = equilibrium(model)
    except StiffmbsError as refusal:
        if "no equilibrium" in str(refusal):
            return Verdict(Outcome.WRONG, detail=f"there is one: {refusal}")
        return Verdict(Outcome.TOLD, detail=str(refusal))
    return _judged(model, found)


def _judged(model: Runnable, found: EquilibriumFound) -> Verdict:
    told_unstable = any("unstable" in note and "lead" not in note for note in found.notes)
    solution = run(model, start_from=found.solution, duration=DURATION, rtol=RTOL, points=21)
    growth = max(
        (value.real for mode in modes(model, start_from=found.solution).modes for value in mode.eigenvalues),
        default=0.0,
    )
    if growth > GROWTH and not told_unstable:
        return Verdict(Outcome.WRONG, growth, GROWTH, f"a mode grows, and no note says so: {found.notes}")
    if told_unstable:
        return Verdict(Outcome.TOLD, detail="; ".join(found.notes))
    pushed = max(abs(float(solution[name][0])) / 9.81 for name in solution if name.endswith(ACCELERATIONS))
    return measured(max(pushed, _moved(solution)), STILL, "; ".join(found.notes))


def _moved(solution: Solution) -> float:
    """How far anything moves from the first instant on."""
    return max(float(np.abs(solution[name] - solution[name][0]).max()) for name in solution if name.endswith(POSES))
