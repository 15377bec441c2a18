"""Independent mechanisms in one scene: solved separately, and all together."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.comparison.sweep import Timed, take_turns
from stiffmbs.model.model_data import ModelData
from stiffmbs.model.read_scene import read_scene

from ..benchmark import Row
from ..drives import SOLVERS

RTOL, ROUNDS = 1e-6, 21
GRAVITY = 9.81


def scene_of(lengths: Mapping[str, float], oscillator: bool) -> ModelData:
    """Pendulums of these lengths, m, beside each other, and a mass on a spring of 3200 rad/s."""
    bodies: dict[str, Any] = {}
    joints: dict[str, Any] = {}
    forces: dict[str, Any] = {}
    for k, (name, length) in enumerate(lengths.items()):
        at, angle = 10.0 * k, 1.0 - 0.3 * k
        place = [at + length * np.sin(angle), -length * np.cos(angle)]
        bodies[name] = {"mass": 1, "inertia": 1e-3 * length**2, "position": place, "angle": angle}
        pin, ground = {"body": name, "point": [0, length]}, {"body": "ground", "point": [at, 0]}
        joints[f"{name}_pin"] = {"type": "revolute", "i": pin, "j": ground}
    if oscillator:
        bodies["mass"] = {"mass": 1e-2, "inertia": 1e-3, "position": [0, 2]}
        spring = {"i": "mass", "j": {"body": "ground", "point": [0, 1]}, "stiffness": 1e5, "free_length": 0.99}
        forces["spring"] = {"type": "spring_damper", **spring}
    run = {"duration": 2, "points": 21}
    content = {"gravity": [0, -GRAVITY], "bodies": bodies, "joints": joints, "forces": forces, "run": run}
    return read_scene(json.dumps(content))


@dataclass(frozen=True)
class Independent:
    """A scene of independent mechanisms; errors are how far the places of its bodies differ between the two."""

    name: str
    lengths: Mapping[str, float]
    oscillator: bool

    def measured(self) -> list[Row]:
        """Medians of runs that take turns."""
        return list(self._rows(ROUNDS))

    def glanced(self) -> list[Row]:
        """One run more than the first."""
        return list(self._rows(1))

    def _rows(self, rounds: int) -> Iterator[Row]:
        model = scene_of(self.lengths, self.oscillator)
        for solver, settings in SOLVERS.items():
            jobs = [prepare(model, rtol=RTOL, presolve=presolve, **settings) for presolve in (True, False)]
            apart, together = (job.integrate() for job in jobs)
            timed = [Timed(partial(job.integrate), []) for job in jobs]
            take_turns(timed, range(rounds))
            error = float(np.max(np.abs(apart.q - together.q)))
            yield Row(solver, "separately", error, timed[0].median, False)
            yield Row(solver, "all together, without presolve", 0.0, timed[1].median, True)


BENCHMARKS = (
    Independent("two_pendulums", {"one": 1.0, "other": 1.02}, False),
    Independent("seven_pendulums_and_a_fast_oscillator", {f"p{k}": 1.0 + 0.02 * k for k in range(7)}, True),
)
