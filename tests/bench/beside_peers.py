"""A problem solved by this package and by other tools, over decades of error."""

from __future__ import annotations

from dataclasses import dataclass

from stiffmbs.comparison.sweep import seconds_of

from .benchmark import Row
from .contestant import Contestant, Failed
from .decades import error_of, over_decades
from .peers import peers
from .problem import Problem

AT_A_GLANCE = 1e-6


@dataclass(frozen=True)
class BesidePeers:
    """A problem with a task for other tools."""

    problem: Problem

    @property
    def name(self) -> str:
        return self.problem.name

    def contestants(self) -> list[Contestant]:
        """This package's, without the yardsticks, and other tools."""
        given = self.problem.task or self.problem.in_space
        assert given is not None
        own = [contestant for contestant in self.problem.contestants() if not contestant.peer]
        return [*own, *peers(given())]

    def measured(self) -> list[Row]:
        """All contestants at all their settings."""
        return over_decades(self.contestants(), self.problem.reference())

    def glanced(self) -> list[Row]:
        """Each at one setting that it comes to an end with, timed once."""
        reference, rows = self.problem.reference(), []
        for c in self.contestants():
            settings = c.settings[len(c.settings) // 2 :: 4] or (AT_A_GLANCE,)
            for setting in settings:
                try:
                    seconds, found = seconds_of(c.at(setting))
                except Failed:
                    continue
                rows.append(Row(c.solver, f"{c.setting} {setting:.3g}", error_of(found, reference), seconds, c.peer))
                break
        return rows
