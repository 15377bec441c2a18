"""One evaluation of accelerations with all reactions, as explicit steps take it, of chains in space and in the plane."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.compile.machine.routines import Routine
from stiffmbs.model.model_data import ModelData

from ..benchmark import Row
from ..by_hand.chain_minimal import accelerations
from ..by_hand.loop import fast
from ..peers import missing
from ..peers.trees.scene import scene_of
from ..peers.trees.tree import Tree
from .chain import chain
from .trees_in_space import tilted_chain

OFTEN = Routine("tests.bench.native.accelerations", "accelerate_often", "int64(int64, float64, float64*, int64*)")
LENGTH = 1.0
ROUNDS, EVALUATIONS = 300, 1000
"""How often the time is taken, and how many rods are evaluated each time; the shortest time counts."""
PEERS = {"pinocchio": "Pinocchio, aba", "mujoco": "MuJoCo, mj_forward"}
LONGEST = 100
"""Chain that other tools are given: of 1000 links the models of both fill 24 GB of memory."""
RODS = (10, 100, 1000)
PER_BODY = 6
"""Velocities of a body in space."""


@dataclass(frozen=True)
class InPlane:
    """A chain of so many rods, in the middle of its motion; errors are against the LU of the whole block system."""

    rods: int

    @property
    def name(self) -> str:
        return f"accelerations_in_plane_{self.rods}"

    def measured(self) -> list[Row]:
        """Shortest times of many."""
        return list(self._rows(ROUNDS))

    def glanced(self) -> list[Row]:
        """Of a few."""
        return list(self._rows(3))

    def _rows(self, rounds: int) -> Iterator[Row]:
        job = _explicit(chain(self.rods, LENGTH))
        trajectory = job.integrate()
        middle = len(trajectory.t) // 2
        q = trajectory.q[middle]
        row, found = _eliminated(job, self.rods, trajectory.t[middle], q, trajectory.u[middle], rounds)
        yield row
        phi, w, h = q[2::3], trajectory.u[middle][2::3], LENGTH / 2
        spin, force, repeats = np.empty(self.rods), np.empty((self.rods + 1, 2)), _repeats(self.rods)
        _recursions(1, phi, w, h, spin, force)
        seconds = _shortest(lambda: _recursions(repeats, phi, w, h, spin, force), rounds) / repeats
        off = float(np.max(np.abs(spin - found[2::3])))
        yield _row("recursion by hand", self.rods, seconds, off, True)


@dataclass(frozen=True)
class InSpace:
    """A chain of so many rods with tilted hinges, let go at rest; errors of other tools are against this package's accelerations of the centres."""

    rods: int

    @property
    def name(self) -> str:
        return f"accelerations_in_space_{self.rods}"

    def measured(self) -> list[Row]:
        """Shortest times of many."""
        return list(self._rows(ROUNDS))

    def glanced(self) -> list[Row]:
        """Of a few."""
        return list(self._rows(3))

    def _rows(self, rounds: int) -> Iterator[Row]:
        tree = tilted_chain(self.rods)
        job = _explicit(scene_of(tree))
        row, found = _eliminated(job, self.rods, 0.0, job.dynamics.state.q.copy(), job.dynamics.state.u.copy(), rounds)
        yield row
        centres = found.reshape(self.rods, PER_BODY)[:, :3]
        for tool, name in PEERS.items():
            if tool not in missing() and self.rods <= LONGEST:
                at_start = importlib.import_module(f"{scene_of.__module__.rpartition('.')[0]}.{tool}").at_start
                off = float(np.max(np.abs(_of_centres(tree, at_start(tree)()) - centres)))
                yield _row(name, self.rods, _without_call(at_start, self.rods, rounds), off, True)


def _explicit(scene: ModelData) -> Job:
    return prepare(scene, solver="projected", rtol=1e-4)


def _eliminated(job: Job, rods: int, t: float, q: np.ndarray, u: np.ndarray, rounds: int) -> tuple[Row, np.ndarray]:
    """The row of this package, its error against the LU, and the accelerations, shape (n_u,)."""
    dynamics, repeats = job.dynamics, _repeats(rods)
    dynamics.state.q[:], dynamics.state.u[:] = q, u
    found = np.empty(dynamics.system.n_u)
    given = repeats, t, found.ctypes.data, dynamics.eliminated.table.ctypes.data
    seconds = _shortest(lambda: OFTEN.call(*given), rounds) / repeats
    off = float(np.max(np.abs(found - dynamics.accelerate(t)[1])))
    return _row("elimination", rods, seconds, off, False), found


def _without_call(at_start: Callable[[Tree], Callable[[], np.ndarray]], rods: int, rounds: int) -> float:
    """Time of an evaluation without that of the call from Python, s: rods beyond the first take the difference to a single one."""
    short, long = (_shortest(at_start(tilted_chain(count)), rounds) for count in (1, rods))
    return (long - short) / (rods - 1) * rods


def _of_centres(tree: Tree, of_hinges: np.ndarray) -> np.ndarray:
    """The accelerations of the centres of mass of a tree at rest, shape (links, 3): they follow from those of hinges as velocities do."""
    moved = replace(tree, links=tuple(replace(link, rate=a) for link, a in zip(tree.links, of_hinges, strict=True)))
    angular, of_hinge = moved.motion_at_start()
    return np.array(
        [v + np.cross(w, link.centre - link.hinge) for link, w, v in zip(tree.links, angular, of_hinge, strict=True)]
    )


def _row(name: str, rods: int, seconds: float, error: float, peer: bool) -> Row:
    return Row(name, f"{seconds / rods * 1e9:.0f} ns a rod", error, seconds, peer)


def _repeats(rods: int) -> int:
    return max(1, EVALUATIONS // rods)


@fast
def _recursions(count, phi, w, h, spin, force):
    """The recursion in the angles, so many times."""
    for _ in range(count):
        accelerations(phi, w, h, spin, force)


def _shortest(work: Callable[[], object], rounds: int) -> float:
    """The shortest time of a call, s: each is short enough to run between other programs."""
    times = []
    for _ in range(rounds):
        begun = time.perf_counter()
        work()
        times.append(time.perf_counter() - begun)
    return min(times)


BENCHMARKS = (*map(InPlane, RODS), *map(InSpace, RODS))
