"""Inputs of a simulation: values in the forces of a scene that change between steps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..analyses.job import Job
from ..analyses.renumber import Change, changes_of_numbers, write_numbers
from ..describe.scene import Scene
from ..errors import InputError
from .case_solver import CaseSolver

TRIED = (-1.7, -0.4, 0.3, 1.0, 2.9, 1e3)
"""Values at which the linearity of force parameters in an input is tested, in addition to zero."""
SAME_NUMBER = 8 * float(np.finfo(float).eps)


@dataclass(frozen=True)
class _Linear:
    """Numbers of a force that depend on an input: numbers[place] = offset + slope * value by (place, offset, slope)."""

    numbers: np.ndarray
    parts: Sequence[tuple[int, float, float]]

    def write(self, value: float) -> None:
        for place, offset, slope in self.parts:  # few parts: a loop is faster than numpy
            self.numbers[place] = offset + slope * value


class InputNumbers:
    """Numbers of a compiled model that depend on inputs.

    Parameters
    ----------
    job : Job
        Job whose forces have the inputs.
    solver : CaseSolver
        Solver of the scene with these inputs.
    values : mapping of str to float
        Inputs, parameters or paths of the scene, with their initial values.

    Raises
    ------
    InputError
        If an input changes more than numbers of forces.
    """

    def __init__(self, job: Job, solver: CaseSolver, values: Mapping[str, float]) -> None:
        self._job, self._solver, self._names = job, solver, tuple(values)
        self.values = dict(values)
        for name in self._names:
            if not changes_of_numbers(job, self._scene({**self.values, name: self.values[name] + 1.0})):
                raise InputError(
                    f"input '{name}': found a value that more than numbers of forces and states follow from, expected one of these "
                    "alone"
                )
        self._quick = self._linear()

    def _scene(self, values: Mapping[str, float]) -> Scene:
        return self._solver.scene([float(values[name]) for name in self._names])

    def set(self, values: Mapping[str, float]) -> bool:
        """Change inputs; return True if any of them has a new value.

        Raises
        ------
        InputError
            If there is no such input, or its value is invalid.
        """
        changed = {name: value for name, value in values.items() if self.values.get(name) != value}
        if not changed:
            return False
        for name, value in changed.items():
            if name not in self.values:
                raise InputError(
                    f"input '{name}': found no such input, expected one of {', '.join(self.values) or 'none'}"
                )
            if not math.isfinite(value):
                raise InputError(f"input '{name}': found {value}, expected a finite number")
        self.values.update(changed)
        if self._quick is None:
            write_numbers(self._job, self._scene(self.values))
            return True
        for name in changed:
            for part in self._quick[name]:
                part.write(self.values[name])
        return True

    def _linear(self) -> dict[str, Sequence[_Linear]] | None:
        """Return the numbers that depend on each input alone and linearly, or None if forces must be read again."""
        found: dict[str, Sequence[_Linear]] = {}
        taken: set[tuple[int, int]] = set()
        for name in self._names:
            parts = self._linear_parts(name)
            if parts is None:
                return None
            places = {(id(part.numbers), place) for part in parts for place, _, _ in part.parts}
            if places & taken:
                return None
            taken |= places
            found[name] = parts
        return found

    def _linear_parts(self, name: str) -> Sequence[_Linear] | None:
        """Return the numbers that equal offset + slope * value at all tested values, or None if any does not."""
        tried = {value: self._changes(name, value) for value in (0.0, 1.0, *TRIED)}
        known = {value: changes for value, changes in tried.items() if changes is not None}
        if len(known) < len(tried):
            return None
        forces = {at: change for changes in known.values() for at, change in changes.items()}
        parts = []
        for at, force in forces.items():
            if force.of_inputs:
                return None
            present = force.group.numbers[force.first :][: len(force.values)].copy()
            found = {value: changes[at].values if at in changes else present for value, changes in known.items()}
            offset, slope = found[0.0], found[1.0] - found[0.0]
            for value, numbers in found.items():
                if not np.allclose(numbers, offset + slope * value, rtol=SAME_NUMBER, atol=SAME_NUMBER * abs(value)):
                    return None
            places = np.flatnonzero(slope)
            rows = ((force.first + places).tolist(), offset[places].tolist(), slope[places].tolist())
            parts.append(_Linear(force.group.numbers, tuple(zip(*rows, strict=True))))
        return parts

    def _changes(self, name: str, value: float) -> dict[tuple[int, int], Change] | None:
        """Return the forces, by their places, that differ from the current ones for a value of an input."""
        try:
            found = changes_of_numbers(self._job, self._scene({**self.values, name: value}))
        except InputError:
            return None
        return None if found is None else {(id(change.group), change.number): change for change in found}
