"""Input of a simulation in formulas of time, whose breakpoints move with its value."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from ..analyses.job import Job
from ..analyses.renumber import Change
from ..compile.inputs.calm import CalmTimes, RangedInput
from ..compile.inputs.of_time import expressions_of, given_in
from ..compile.inputs.table_ranges import TableRanges
from ..errors import InputError
from ..model.scene import Scene
from ..tuning import in_use
from .stepping import STEPPING

_NEVER = CalmTimes([], 0.0, 0.0, 1)
"""No time is without features."""


class VariedInput:
    """Input whose numbers follow its value at once, and the formulas of its elements when features are determined.

    Times without features are known for all values of the input within bounds, which widen to each value.

    `job`: job whose forces have the input. `values`: values of all inputs. `found_at`: function that returns the scene
    with other values of some, and the forces that change. `write`: function that gives the elements the current values.
    """

    def __init__(
        self, job: Job, name: str, values: Mapping[str, float],
        found_at: Callable[[Mapping[str, float]], tuple[Scene, list[Change]]], write: Callable[[], None],
    ) -> None:  # fmt: skip
        self._job, self._name, self._found_at, self._write = job, name, found_at, write
        self._value = values[name]
        self._is_stale = False
        self._least, self._largest, self._end = np.inf, -np.inf, -np.inf
        self._inputs: list[RangedInput] = []
        self._calm = _NEVER

    def take(self, values: Mapping[str, float]) -> None:
        """Note a new value of the input, whose features are not determined yet."""
        if values[self._name] != self._value:
            self._value, self._is_stale = values[self._name], True
            self._job.dynamics.forget_inputs()

    def catch_up(self) -> None:
        """Give the elements the current values, if they have others."""
        if self._is_stale:
            self._is_stale = False
            self._write()

    def is_calm(self, t: float, end: float) -> bool:
        """Return True if features are not determined, but a step between two times, s, is known to meet none."""
        if not self._is_stale:
            return False
        if not (self._least <= self._value <= self._largest and end <= self._end):
            with in_use(self._job.settings.tuning):
                self._find(t, end)
        if self._calm.has_step(t, end):
            return True
        of_step = CalmTimes([each.at(self._part) for each in self._inputs], t, end, cells=1)
        return len(self._inputs) > 0 and of_step.has_step(t, end)

    @property
    def _part(self) -> float:
        """Return the place of the value between the bounds, from 0 to 1."""
        return (self._value - self._least) / (self._largest - self._least or 1.0)

    def _find(self, t: float, end: float) -> None:
        """Find the times without features again, from a time on, for wider bounds."""
        reach = STEPPING.reach * abs(self._value)
        self._least = min(self._least, self._value - reach)
        self._largest = max(self._largest, self._value + reach)
        self._end = end + self._job.settings.duration
        try:
            self._inputs = list(self._ranged(self._least, self._largest))
            self._calm = CalmTimes(self._inputs, t, self._end, STEPPING.cells)
        except InputError:  # a bound is refused, or changes more than numbers
            self._inputs, self._calm = [], _NEVER

    def _ranged(self, least: float, largest: float) -> Iterator[RangedInput]:
        known: dict[int, TableRanges] = {}
        for lower, upper in zip(self._expressions(least), self._expressions(largest), strict=True):
            (tree, _, values, tables), (_, _, others, other_tables) = lower, upper
            if tables != other_tables:
                raise InputError("found a table that changes with an input")
            ranges = {name: known.setdefault(id(table), TableRanges(table)) for name, table in tables.items()}
            yield RangedInput(tree, values, others, ranges)

    def _expressions(self, value: float) -> Iterator[Any]:
        """Yield the expressions of time of all elements with a value of the input, as `expressions_of`."""
        system = self._job.dynamics.system
        scene, changes = self._found_at({self._name: value})
        changed = {(id(change.group), change.number): change.element for change in changes}
        given = given_in({**system.outputs, **scene.state_outputs()})
        for group in system.groups:
            for number, element in enumerate(group.elements if group.has_inputs else ()):
                yield from expressions_of(changed.get((id(group), number), element), given)
