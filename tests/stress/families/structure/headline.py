"""Loops that may lock, steps that miss pushes and motions that grow: the message of a run says when its results are in doubt.

A run whose message has no doubt must agree with a closed form, and its notes must not say that its results may be wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs import spatial
from stiffmbs.analyses.run import run
from stiffmbs.elements.planar_kinds import FORCES
from stiffmbs.model.read_scene import read_scene
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import IN_DOUBT
from stiffmbs.solve.trajectory import Outcome as Ending

from ...case import Case, Outcome, Verdict, measured, told
from ...mechanisms.parallelogram import parallelogram
from ...mechanisms.pendulum import GRAVITY, swing
from ...simulation import patience

LATE = 1e-3
"""Error, rad or m, that no run without a doubt has."""
PATIENCE = 4.0
"""Processor time, s, after which a run is interrupted."""
DOUBTS = ("may be wrong", "the motion diverges", "constraint drift")


def loop(cranks: int, torque: float, space: bool, omega: float) -> Any:
    """Return a parallelogram whose first and last crank are turned against each other."""
    model = parallelogram(cranks, omega=omega)
    for k, way in ((0, 1), (cranks - 1, -1)):
        model.add(f"against{k}", FORCES["torque"](i=f"crank{k}", torque=way * torque))
    return spatial.in_space(model) if space else model


def swing_of(cranks: int, omega: float, solution: Solution) -> float:
    """Return the error of the first crank's angle against a pendulum: the two torques cancel."""
    rate = np.sqrt(GRAVITY * (cranks / 2 + 1) / (cranks / 3 + 1))
    angle = np.unwrap(np.arctan2(solution["crank0.y"], solution["crank0.x"])) + np.pi / 2
    return float(np.max(np.abs(angle - swing(solution.t, np.pi / 4, rate, omega))))


def grows(dimensions: int, law: str) -> Any:
    """Return a body under a force that grows with its distance."""
    zeros, inertia = ", 0" * (dimensions - 1), "1" if dimensions == 2 else "[1, 1, 1]"
    return read_scene(
        f"dimensions: {dimensions}\nbodies: {{b: {{mass: 1, inertia: {inertia}, position: [1{zeros}]}}}}\n"
        f"forces: {{f: {{type: force, i: b, force: ['{law}'{zeros}]}}}}\n"
    )


def _judged(scene: Callable[[], Any], error: Callable[[Solution], float], words: str, how: dict[str, Any]) -> Verdict:
    solution = run(scene(), watch=patience(PATIENCE), **how)
    found, notes = error(solution), "; ".join(solution.notes)
    if solution.outcome is not Ending.DONE:
        return told(solution.message, ("t = ",), found, LATE)
    if solution.message.startswith(IN_DOUBT):
        return told(solution.message, (words,))
    doubts = [doubt for doubt in DOUBTS if doubt in notes and "was repeated" not in notes]
    if doubts:
        return Verdict(Outcome.WRONG, found, LATE, f"'{solution.message}' with the notes {notes}")
    return measured(found, LATE, notes)


def _loop(cranks: int, torque: float, space: bool, omega: float, expected: Outcome, **how: Any) -> Case:
    name = f"{cranks} cranks, +-{torque:.0e} N m, {omega:g} rad/s{', in space' if space else ''} {how or ''}"
    scene, error = partial(loop, cranks, torque, space, omega), partial(swing_of, cranks, omega)
    judge = partial(_judged, scene, error, "constraint drift", {"duration": 3.0, "points": 61, **how})
    return Case(name, "a pendulum, or a message that the results are in doubt", judge, expected)


def _growth(
    dimensions: int, law: str, duration: float, error: Callable[[Solution], float], expected: Outcome, **how: Any
) -> Case:
    judge = partial(
        _judged,
        partial(grows, dimensions, law),
        error,
        "the motion diverges",
        {"duration": duration, "points": 81, **how},
    )
    return Case(
        f"force {law} for {duration:g} s in {dimensions}D {how or ''}", "a closed form, or the same", judge, expected
    )


def _vibration(stiffness: float, solution: Solution) -> float:
    x = np.cosh(np.sqrt(-stiffness + 0j) * solution.t).real
    return float(np.max(np.abs(solution["b.x"] - x)))


BDF: dict[str, Any] = {"solver": "bdf"}

CASES = (
    _loop(2, 1e2, False, 0.0, Outcome.RIGHT),
    _loop(2, 1e5, False, 0.0, Outcome.RIGHT, **BDF),
    _loop(2, 1e7, False, 0.0, Outcome.RIGHT, solver="projected"),
    _loop(2, 1e9, False, 0.0, Outcome.RIGHT, formulation="SI1", **BDF),
    _loop(2, 1e11, False, 3.2, Outcome.RIGHT, **BDF),
    _loop(2, 1e7, False, 8.0, Outcome.TOLD, **BDF),
    _loop(3, 1e5, False, 0.0, Outcome.RIGHT, **BDF),
    _loop(2, 1e5, True, 0.0, Outcome.RIGHT, **BDF),
    _loop(2, 1e7, True, 8.0, Outcome.TOLD, **BDF),
    *(
        _growth(dimensions, "9*b.x", 8.0, partial(_vibration, -9.0), Outcome.TOLD, solver=solver)
        for dimensions in (2, 3) for solver in ("bdf", "projected", "auto")
    ),
    _growth(2, "9*b.x", 1.0, partial(_vibration, -9.0), Outcome.RIGHT, **BDF),
    _growth(3, "-9*b.x", 8.0, partial(_vibration, 9.0), Outcome.RIGHT, solver="projected"),
)  # fmt: skip
