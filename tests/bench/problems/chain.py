"""Chains of pinned rods let go from the horizontal, 2 s with 201 output points: nothing in them is stiff.

Rods of 0.1 m as in ``examples/chain.yaml``, where a chain of ten is chaotic within the two seconds, and of 1 m.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.model.model_data import ModelData
from stiffmbs.model.read_scene import read_scene

from ..by_hand import chain as hand
from ..by_hand import chain_minimal
from ..contestant import Contestant, auto, bdf, bdf_of_all, by_hand, converged, dop853, minimal
from ..problem import Problem
from ..task import Minimal, Task

SCENE = """
name: Chain
parameters: {{N: {rods}, L: {length} m}}
gravity: [0, -9.81]
bodies:
  link{{k}}: {{for: k in 1..N, mass: 0.1 kg, inertia: 0.1 kg*L^2/12, position: [(k - 0.5)*L, 0]}}
joints:
  pin1: {{type: revolute, i: {{body: link1, point: [-L/2, 0]}}, j: ground}}
  pin{{k}}:
    for: k in 2..N
    type: revolute
    i: {{body: "link{{k}}", point: [-L/2, 0]}}
    j: {{body: "link{{k-1}}", point: [L/2, 0]}}
run: {{duration: 2, points: 201}}
"""
TIMES = np.linspace(0.0, 2.0, 201)
LAST_AT_END = {10: (0.383878994719, -0.200667490192), 100: (-7.572975444743, -5.793758739116)}
"""Where the centre of the last rod of 0.1 m is after 2 s: this package's dop853 and dopri5 at rtol 1e-14 and 1e-12, and
minimal equations with SciPy's DOP853 at rtol 1e-13, agree to 2e-11."""


def chain(rods: int, length: float) -> ModelData:
    """The chain of so many rods of a length, m."""
    return read_scene(SCENE.format(rods=rods, length=length))


def contestants(rods: int, length: float) -> list[Contestant]:
    """This package beside banded SI2 by hand and the recursion in the angles."""
    scene = chain(rods, length)
    rates = partial(chain_minimal.minimal, h=length / 2)
    places = partial(chain_minimal.places, h=length / 2)
    return [
        bdf(scene), bdf_of_all(scene), by_hand(hand.si2(rods, length), TIMES), dop853(scene),
        minimal(rates, np.zeros(2 * rods), places, TIMES), auto(scene),
    ]  # fmt: skip


def reference(rods: int, length: float) -> np.ndarray:
    """The converged coordinates."""
    half = length / 2
    rates, places = partial(chain_minimal.minimal, h=half), partial(chain_minimal.places, h=half)
    return converged(rates, np.zeros(2 * rods), places, TIMES)


def task(rods: int, length: float) -> Task:
    """The problem for other tools."""
    half = length / 2
    rates, places = partial(chain_minimal.minimal, h=half), partial(chain_minimal.places, h=half)
    return Task(chain(rods, length), TIMES, Minimal(rates, np.zeros(2 * rods), places))


def _problem(rods: int, length: float) -> Problem:
    name = f"chain_{rods}" if length == 0.1 else f"chain_{rods}_of_{length:g}_m"
    effort = {10: (4, 9), 100: (4, 5), 1000: (2, 1)}
    per_decade, rounds = effort[rods]
    given = (rods, length)
    return Problem(
        name, partial(reference, *given), partial(contestants, *given), (1e-4, 1e-12), per_decade, rounds,
        partial(task, *given),
    )  # fmt: skip


BENCHMARKS = tuple(_problem(*size) for size in ((10, 1.0), (100, 1.0), (1000, 1.0), (10, 0.1), (100, 0.1)))
