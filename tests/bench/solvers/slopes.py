"""Time of slopes written by hand beside forward mode: ``python -m tests.bench.solvers.slopes [SCENE]...``.

A line for each scene: the least times to evaluate all terms of motion, the derivatives for the iteration matrix, and the terms
of motion with their derivatives in one direction, us; and the number of directions in which the matrix has derivatives.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from timeit import repeat

from stiffmbs import load_scene
from stiffmbs.analyses.job import prepare
from stiffmbs.compile.directional.direction import ALONG, Direction, unchanged
from stiffmbs.compile.directional.source import STATE
from stiffmbs.compile.machine.routines import fully_compiled

SCENES = ("examples/beams/rotor.yaml", "examples/beams/cable.yaml", "examples/flexible/flexible_slider_crank.yaml")
CALLS, REPEATS = 300, 9


def least(function: Callable[[], object]) -> float:
    """The least time of a call, us."""
    return min(repeat(function, number=CALLS, repeat=REPEATS)) / CALLS * 1e6


def main(scenes: tuple[str, ...]) -> None:
    with fully_compiled():
        for path in scenes:
            scene = load_scene(path)
            job = prepare(scene, scene.run)
            state, system = job.dynamics.state, job.dynamics.system
            direction = Direction(state, "motion", unchanged(system), STATE)
            direction.q[:], direction.u[:] = 0.1, 0.1
            at = state.table.ctypes.data, direction.table.ctypes.data
            times = (
                least(partial(state.evaluate, "motion", 0.0)),
                least(partial(state.evaluate, "tangent", 0.0)),
                least(partial(ALONG.call, 0.0, 0.0, *at)),
            )
            words = ("terms", "derivatives for the matrix", "terms in one direction")
            shown = ", ".join(f"{word} {time:.1f}" for word, time in zip(words, times, strict=True))
            print(f"{path}: {shown} us; {system.n_q + system.n_u} directions")


if __name__ == "__main__":
    main(tuple(sys.argv[1:]) or SCENES)
