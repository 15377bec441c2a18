"""A problem with a reference: run time against error, contestants taking turns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .benchmark import Row
from .contestant import Contestant
from .peers.flexible.tasks import HungBeam, HungBody
from .peers.mounted.mounted import Shaken
from .peers.trees.tree import Tree
from .sweep import Point, at_target, points
from .task import Task

AT_A_GLANCE = 1e-8
"""The tolerance of a quick look."""


@dataclass(frozen=True)
class Problem:
    """A problem and the ways to solve it.

    Attributes
    ----------
    name : str
    reference : callable
        The converged coordinates of all bodies at all output times, by other means than this package; called once.
    contestants : callable
        What is measured on it; called once.
    tolerances : (float, float)
        Loosest and tightest relative tolerance that are tried.
    per_decade : int
        How many of them.
    rounds : int
        How often each contestant is timed at each tolerance.
    task : callable, optional
        A planar problem as it is put to other tools.
    in_space : callable, optional
        The same of links on hinges, of bodies on bushings, or of flexible bodies.
    """

    name: str
    reference: Callable[[], np.ndarray]
    contestants: Callable[[], list[Contestant]]
    tolerances: tuple[float, float] = (1e-4, 1e-11)
    per_decade: int = 4
    rounds: int = 9
    task: Callable[[], Task] | None = None
    in_space: Callable[[], Tree | Shaken | HungBeam | HungBody] | None = None

    def measured(self, target: float = 1e-6) -> list[Row]:
        """All contestants at tolerances whose errors are about a target.

        Returns
        -------
        list of Row
            One for each contestant and tolerance, and for each contestant the time at the target error.
        """
        reference, contestants = self.reference(), self.contestants()
        found = [p for c in contestants for p in points(c, self._tried(), reference, target)]
        for _ in range(self.rounds):
            for point in found:
                point.measure()
        rows = [point.row() for point in found]
        return [*rows, *(row for c in contestants for row in at_target(c, rows, target))]

    def _tried(self) -> np.ndarray:
        loosest, tightest = np.log10(self.tolerances)
        return 10.0 ** np.linspace(loosest, tightest, round((loosest - tightest) * self.per_decade) + 1)

    def glanced(self) -> list[Row]:
        """Each contestant at one tolerance and timed once."""
        reference, rows = self.reference(), []
        for contestant in self.contestants():
            solve = contestant.at(AT_A_GLANCE)
            point = Point(contestant, AT_A_GLANCE, solve, float(np.max(np.abs(solve() - reference))), [])
            point.measure()
            rows.append(point.row())
        return rows
