"""Random constraints: the presolve, and now and then the explicit integrator, against the whole model."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict, measured
from ..random_constraints import random_constraints
from ..random_space_constraints import random_space_constraints

WHAT = "mechanisms with random joints, curves, couplers, tables and formulas: the same motion with and without presolve"
IN_SPACE = 0.2
"""Part of the trials in space."""
EXPLICIT = 0.25
"""Part of the trials that the explicit integrator solves as well."""
DURATION = 0.6
HOW: dict[str, Any] = {"duration": DURATION, "points": 61, "max_step": 0.01}
"""Steps short enough for any feature of a law, so that the presolve alone is judged."""
TOLERANCES = 1e-7, 1e-10
"""Of a first pair of runs, and of a second one where those differ: an error of integration becomes less."""
ALLOWED = 1e-4
"""Difference of a coordinate or velocity, relative to its largest value and at least of 1 m, rad, m/s, rad/s."""
DOUBTFUL = "the motion depends on the last digits"
"""In the note of a scene whose motion is no matter of its equations alone."""
IN_DOUBT = "the results may be wrong"
"""In a note of both runs, where they need not agree."""
COORDINATES = ("x", "y", "z", "angle", "vx", "vy", "vz", "omega", "wx", "wy", "wz")


def trial(seed: int) -> Verdict:
    """Make a scene and solve it in two ways."""
    scene = scene_of(seed)
    other: dict[str, Any] = {"presolve": False}
    if np.random.default_rng([seed, 1]).random() < EXPLICIT:
        other = {"solver": "projected", "scheme": "dop853"}
    verdict = _compared(scene, other, TOLERANCES[0])
    if verdict.outcome is Outcome.WRONG:
        verdict = _compared(scene, other, TOLERANCES[1])
    return verdict


def scene_of(seed: int) -> Scene:
    """The scene of a trial."""
    rng = np.random.default_rng([seed, 0])
    content = random_space_constraints(rng) if rng.random() < IN_SPACE else random_constraints(rng)
    return read_scene(json.dumps(content))


def _compared(scene: Scene, other: dict[str, Any], rtol: float) -> Verdict:
    with_it, without = _solved(scene, rtol), _solved(scene, rtol, **other)
    if isinstance(with_it, str) or isinstance(without, str):
        return _refusals(with_it, without)
    doubt = next((note for note in with_it.notes if DOUBTFUL in note), None)
    if all(any(IN_DOUBT in note for note in solution.notes) for solution in (with_it, without)):
        doubt = doubt or next(note for note in with_it.notes if IN_DOUBT in note)
    count = min(len(with_it.t), len(without.t))
    error, channel = max(_errors(with_it, without, count), default=(0.0, ""))
    if doubt and not error <= ALLOWED:
        return Verdict(Outcome.TOLD, error, ALLOWED, doubt)
    stopped = [solution for solution in (with_it, without) if solution.outcome is not Ending.DONE]
    if len(stopped) == 1 and not doubt:
        detail = f"one run ends at {stopped[0].t[-1]:.4g} s: {stopped[0].message}"
        return Verdict(Outcome.WRONG, error, ALLOWED, detail)
    if stopped and error <= ALLOWED:
        return Verdict(Outcome.TOLD, error, ALLOWED, with_it.message)
    return measured(error, ALLOWED, f"{channel}, {other}")


def _solved(scene: Scene, rtol: float, **how: Any) -> Solution | str:
    try:
        return run(scene, rtol=rtol, **HOW, **how)
    except StiffmbsError as refusal:
        return str(refusal)


def _refusals(with_it: Solution | str, without: Solution | str) -> Verdict:
    if isinstance(with_it, str) and isinstance(without, str):
        return Verdict(Outcome.TOLD, detail=with_it)
    refused = with_it if isinstance(with_it, str) else without
    return Verdict(Outcome.WRONG, detail=f"refused by one of two alone: {refused}")


def _errors(with_it: Solution, without: Solution, count: int) -> Iterator[tuple[float, str]]:
    """The difference of each coordinate and velocity of a body, and its channel."""
    for channel in with_it:
        owner, _, name = channel.partition(".")
        if owner.startswith("b") and name in COORDINATES:
            a, b = with_it[channel][:count], without[channel][:count]
            yield float(np.max(np.abs(a - b)) / max(1.0, float(np.max(np.abs(b))))), channel
