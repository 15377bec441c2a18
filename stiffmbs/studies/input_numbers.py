"""Inputs of a simulation, whose values in forces and states change between steps, and its continuous angles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..analyses.job import Job
from ..analyses.renumber import Change, changes_of_numbers, write_numbers
from ..dynamics.dynamics import OutputRows
from ..elements.turns import TURN
from ..errors import InputError
from ..model.scene import Scene
from ..reading.did_you_mean import instead_of
from ..results.joint_angles import joint_angles
from .case_solver import CaseSolver

MOST_KEPT = 1000
"""Number of states that are kept before their angles are computed."""


class FollowedTurns:
    """Continuous angles of the spatial joints whose turns the integration does not count.

    They follow from the rates at the ends of all steps, as in a run with these output times. `t`: start, s. `known`:
    channels at the start, with angles in their turns.
    """

    def __init__(self, job: Job, t: float, q: np.ndarray, u: np.ndarray, known: Mapping[str, float]) -> None:
        self._dynamics = job.dynamics
        self._angles = joint_angles(job.dynamics.system)
        self._known = dict(known)
        self.any = self._angles is not None and bool(self._angles.followed)
        self._states = [(t, q.copy(), u.copy())]
        self._last: list[OutputRows] = []  # row of the state up to which turns are counted

    def note(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """Keep the state at the end of a step."""
        self._states.append((t, q.copy(), u.copy()))
        if len(self._states) > MOST_KEPT:
            self.angles()

    def angles(self, row: OutputRows | None = None) -> dict[str, float]:
        """Return the angles at the last state, rad, by channel; `row` is its output row if it is known."""
        assert self._angles is not None
        between = self._states if row is None else self._states[:-1]
        parts = [*self._last, *([self._reported(between)] if between else []), *([row] if row is not None else [])]
        parts = [part for part in parts if len(part.t)]
        if self._states and parts:
            t, q, values = (np.concatenate([getattr(part, name) for part in parts]) for name in ("t", "q", "values"))
            found = self._angles.continuous(replace(parts[-1], t=t, q=q, values=values))
            self._known = {
                name: found[name].item(-1) + TURN * round((self._known.get(name, first) - first) / TURN)
                for name, first in ((name, found[name].item(0)) for name in self._angles.followed)
            }
            self._states, self._last = [], [replace(parts[-1], t=t[-1:], q=q[-1:], values=values[-1:])]
        return self._known

    def _reported(self, states: Sequence[tuple[float, np.ndarray, np.ndarray]]) -> OutputRows:
        t, q, u = (np.array(each) for each in zip(*states, strict=True))
        with self._dynamics.state.unchanged():
            return self._dynamics.report(t, q, u, project=False)


TRIED: Final = (0.0, *(sign * 10.0**k for k in (0, -1, 3) for sign in (1, -1)))
"""Values at which the linearity of force parameters in an input is tested."""
SAME_NUMBER = 8 * float(np.finfo(float).eps)


Linear = list[tuple[np.ndarray, int, float, float]]
"""Numbers of forces that depend on an input: numbers[place] = offset + slope * value."""


class InputNumbers:
    """Numbers of a compiled model that depend on inputs.

    `job`: job whose forces have the inputs. `solver`: solver of the scene with these inputs. `values`: inputs,
    parameters or paths of the scene, with their initial values. Raises InputError if an input changes more than numbers
    of forces and states.
    """

    def __init__(self, job: Job, solver: CaseSolver, values: Mapping[str, float]) -> None:
        self._job, self._solver, self._names = job, solver, tuple(values)
        self.values = dict(values)
        for name in self._names:
            if not changes_of_numbers(job, self._scene({**self.values, name: self.values[name] + 1.0})):
                raise InputError(
                    f"input '{name}': found an input that affects more than numbers of forces and states, expected one "
                    "that affects only these"
                )
        self._quick = self._linear()

    def _scene(self, values: Mapping[str, float]) -> Scene:
        return self._solver.scene([float(values[name]) for name in self._names])

    def set(self, values: Mapping[str, float]) -> bool:
        """Change inputs; return True if any of them has a new value.

        Raises InputError, with nothing changed, if there is no such input, or its value is invalid or changes more
        than numbers of forces and states.
        """
        changed = {name: value for name, value in values.items() if self.values.get(name) != value}
        if not changed:
            return False
        for name, value in changed.items():
            if name not in self.values:
                raise InputError(f"input '{name}': found no such input{instead_of(name, self.values)}")
            if not math.isfinite(value):
                raise InputError(f"input '{name}': found {value}, expected a finite number")
        if self._quick is None:
            self._write(changed)
        else:
            for name, value in changed.items():
                for numbers, place, offset, slope in self._quick[name]:  # few: a loop is faster than numpy
                    numbers[place] = offset + slope * value
        self.values.update(changed)
        return True

    def _write(self, changed: Mapping[str, float]) -> None:
        """Write the numbers of the scene with changed inputs; later changes are found against this scene."""
        scene = self._scene({**self.values, **changed})
        if not write_numbers(self._job, scene):
            found = ", ".join(f"input '{name}': found {value:g}" for name, value in changed.items())
            raise InputError(
                f"{found}, which changes more than numbers of forces and states, such as the form of a force, expected a value "
                "that changes only these"
            )
        self._job = replace(self._job, data=scene)

    def _linear(self) -> dict[str, Linear] | None:
        """Return the numbers that depend on each input alone and linearly, or None if forces must be read again.

        The formulas of the scene must show that all are affine; values at some points find the numbers.
        """
        if not all(self._solver.is_affine(k) for k in range(len(self._names))):
            return None
        found: dict[str, Linear] = {}
        taken: set[tuple[int, int]] = set()
        for name in self._names:
            parts = self._linear_parts(name)
            places = {(id(numbers), place) for numbers, place, _, _ in parts or ()}
            if parts is None or places & taken:
                return None
            taken |= places
            found[name] = parts
        return found

    def _linear_parts(self, name: str) -> Linear | None:
        """Return the numbers that equal offset + slope * value at all tested values, or None if any does not."""
        tried = {value: self._changes(name, value) for value in TRIED}
        known = {value: changes for value, changes in tried.items() if changes is not None}
        if len(known) < len(tried):
            return None
        parts: Linear = []
        for at, force in {at: change for changes in known.values() for at, change in changes.items()}.items():
            if force.of_inputs:
                return None
            present = force.group.numbers[force.first :][: len(force.values)].copy()
            found = {value: changes[at].values if at in changes else present for value, changes in known.items()}
            offset, slope = found[0.0], found[1.0] - found[0.0]
            for value, numbers in found.items():
                if not np.allclose(numbers, offset + slope * value, rtol=SAME_NUMBER, atol=SAME_NUMBER * abs(value)):
                    return None
            parts += [
                (force.group.numbers, force.first + int(k), float(offset[k]), float(slope[k]))
                for k in np.flatnonzero(slope)
            ]
        return parts

    def _changes(self, name: str, value: float) -> dict[tuple[int, int], Change] | None:
        """Return the forces, by their places, that differ from the current ones for a value of an input."""
        try:
            found = changes_of_numbers(self._job, self._scene({**self.values, name: value}))
        except InputError:
            return None
        return None if found is None else {(id(change.group), change.number): change for change in found}
