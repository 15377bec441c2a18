"""Inputs of a simulation, whose values in forces and states change between steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, TypeAlias

import numpy as np

from ..analyses.job import Job
from ..analyses.renumber import Change, changes_of_numbers, write_numbers
from ..dynamics.held_inputs import AffineNumber, HeldInputs
from ..errors import InputError
from ..model.scene import Scene
from ..reading.did_you_mean import instead_of
from ..reading.units.quantity import LARGEST
from ..run_checks.tables import may_refuse
from .case_solver import CaseSolver
from .varied_input import VariedInput

Inputs: TypeAlias = Mapping[str, float] | Sequence[float] | np.ndarray
"""Values of inputs by name, or of all of them in their order."""
TRIED: Final = (0.0, *(sign * 10.0**k for k in (0, -1, 3) for sign in (1, -1)))
"""Values at which the linearity of force parameters in an input is tested."""
BEYOND: Final = 10.0
"""Factor of an accepted value to which the bounds of an input are widened."""
OF_NUMBERS: Final = "which changes more than numbers of forces and states, such as the form of a force, expected a value that changes only these"
SAME_NUMBER = 8 * float(np.finfo(float).eps)


class InputNumbers:
    """Numbers of a compiled model that depend on inputs.

    `job`: job whose forces have the inputs. `solver`: solver of the scene with these inputs. `values`: inputs,
    parameters or paths of the scene, with their initial values. Raises InputError if an input changes more than numbers
    of forces and states.

    - `names`: names of the inputs, in their order.
    - `held`: their values, and the numbers that are affine functions of one.
    - `affine`: true if these are all numbers that depend on inputs; otherwise the scene is read again at each change.
    - `of_time`: true if breakpoints of formulas of time depend on an input.
    """

    def __init__(self, job: Job, solver: CaseSolver, values: Mapping[str, float]) -> None:
        self._job, self._solver, self.names = job, solver, tuple(values)
        self._places = {name: k for k, name in enumerate(values)}
        for name in self.names:
            if not changes_of_numbers(job, self._scene({**values, name: values[name] + 1.0})):
                raise InputError(
                    f"input '{name}': found an input that affects more than numbers of forces and states, expected one "
                    "that affects only these"
                )
        self._of_time: set[int] = set()
        found = self._affine_numbers(values)
        if len(self._of_time) > 1 or (self._of_time and may_refuse(job.dynamics.system)):
            found = None
        self.affine, self.of_time = found is not None, bool(self._of_time)
        self.held = HeldInputs([*values.values()], found or ())
        self.held.least[:] = np.minimum(self.held.least, min(TRIED))
        self.held.largest[:] = np.maximum(self.held.largest, max(TRIED))
        self._varied = self._vary(*self._of_time) if found and self._of_time else None

    def _scene(self, values: Mapping[str, float]) -> Scene:
        return self._solver.scene([float(values[name]) for name in self.names])

    @property
    def values(self) -> dict[str, float]:
        """Return the current values by name."""
        return dict(zip(self.names, self.held.values.tolist(), strict=True))

    def set(self, values: Inputs) -> bool:
        """Change inputs; return True if any of them has a new value.

        `values`: by name, others keep theirs; or all of them, in the order of `names`. Raises InputError, with nothing
        changed, if there is no such input, or a value is invalid or changes more than numbers of forces and states.
        """
        wanted = self.held.wanted
        self._fill(wanted, values)
        if self.affine:
            status = self.held.hold()
            if status < 0:
                self._check_finite(wanted)
                self._widen(wanted)
                status = self.held.hold()
            if status > 0 and self._varied:
                self._varied.take(self.values)
            return status > 0
        self._check_finite(wanted)
        changed = {
            name: new
            for name, new, old in zip(self.names, wanted.tolist(), self.held.values.tolist(), strict=True)
            if new != old
        }
        if changed:
            self._write(changed)
            self.held.values[:] = wanted
        return bool(changed)

    def rows(self, values: Inputs | None, n: int) -> np.ndarray:
        """Return the inputs of n steps, one row for each: given rows, or equal ones of given or of the current values.

        Raises InputError if there is no such input, or if values are invalid.
        """
        if values is None or isinstance(values, Mapping) or np.ndim(_numbers(values)) < 2:
            first = self.held.values.copy()
            if values is not None:
                self._fill(first, values)
            found = np.tile(first, (n, 1))
        else:
            found = np.ascontiguousarray(_numbers(values))
            self._check_shape(found, (n,))
        self._check_finite(found)
        return found

    def _vary(self, moving: int) -> VariedInput:
        """Return the input with an index as one that moves breakpoints."""
        varied = VariedInput(self._job, self.names[moving], self.values, self._found_at, self._read_elements)
        self._job.dynamics.follow(varied)
        return varied

    def _read_elements(self) -> None:
        """Read the elements with the current inputs; their numbers stay those of the affine functions to the last bit."""
        self._write({})
        self.held.write()

    def _found_at(self, values: Mapping[str, float]) -> tuple[Scene, list[Change]]:
        """Return the scene with some values of inputs, and the forces that differ from those of the last scene read.

        Raises InputError if the scene refuses a value, or if it changes more than numbers.
        """
        scene = self._scene({**self.values, **values})
        found = changes_of_numbers(self._job, scene)
        if found is None:
            named = ", ".join(f"input '{name}': found {value:g}" for name, value in values.items())
            raise InputError(f"{named}, {OF_NUMBERS}")
        return scene, found

    def valid_rows(self, rows: np.ndarray) -> int:
        """Return the number of rows of affine inputs before the first one that the scene refuses."""
        for row in np.flatnonzero(((rows < self.held.least) | (rows > self.held.largest)).any(axis=1)).tolist():
            try:
                self._widen(rows[row])
            except InputError:
                return int(row)
        return len(rows)

    def _widen(self, values: np.ndarray) -> None:
        """Widen the bounds of affine inputs to some values, or raise an InputError if the scene refuses one of these.

        The values that a field of a scene accepts are an interval. Bounds beyond these values save readings of the scene.
        """
        held = self.held
        for k in np.flatnonzero((values < held.least) | (values > held.largest)).tolist():
            name, value = self.names[k], float(values[k])
            self._found_at({name: value})
            try:
                self._found_at({name: BEYOND * value})
                value *= BEYOND
            except InputError:
                pass
            held.least[k], held.largest[k] = min(held.least[k], value), max(held.largest[k], value)

    def _fill(self, wanted: np.ndarray, values: Inputs) -> None:
        """Fill an array with all inputs; those that are not given keep their values."""
        if isinstance(values, np.ndarray) and values.shape == wanted.shape and values.dtype.kind == "f":
            wanted[:] = values
        elif isinstance(values, Mapping):
            wanted[:] = self.held.values
            for name, value in values.items():
                if name not in self._places:
                    raise InputError(f"input '{name}': found no such input{instead_of(name, self._places)}")
                wanted[self._places[name]] = _number(value)
        else:
            numbers = _numbers(values)
            self._check_shape(numbers, ())
            wanted[:] = numbers

    def _check_shape(self, values: np.ndarray, rows: tuple[int, ...]) -> None:
        """Raise an InputError if an array has not one column for each input, and these rows."""
        shape, expected = values.shape, (*rows, len(self.names))
        if shape != expected:
            raise InputError(
                f"inputs: found an array of shape {shape}, expected {expected}, one column for each of {', '.join(self.names) or 'no inputs'}"
            )

    def _check_finite(self, values: np.ndarray) -> None:
        """Raise an InputError that names the first input without a finite value, or with one too large to compute with."""
        bad = np.argwhere(~(np.abs(values) < LARGEST))
        if len(bad):
            at = tuple(bad[0].tolist())
            row = f" in row {at[0]}" if len(at) > 1 else ""
            expected = f"a size below {LARGEST:g}" if np.isfinite(values[at]) else "a finite number"
            raise InputError(f"input '{self.names[at[-1]]}': found {values[at]}{row}, expected {expected}")

    def _write(self, changed: Mapping[str, float]) -> None:
        """Write the numbers of the scene with changed inputs; later changes are found against this scene."""
        scene = self._scene({**self.values, **changed})
        if not write_numbers(self._job, scene):
            found = ", ".join(f"input '{name}': found {value:g}" for name, value in changed.items())
            raise InputError(f"{found}, {OF_NUMBERS}")
        self._job = replace(self._job, data=scene)

    def _affine_numbers(self, values: Mapping[str, float]) -> list[AffineNumber] | None:
        """Return the numbers that depend on one input each, as affine functions, or None if forces must be read again.

        The formulas of the scene must show that all are affine; values at some points find the numbers.
        """
        if not all(self._solver.is_affine(k) for k in range(len(self.names))):
            return None
        found: list[AffineNumber] = []
        taken: set[tuple[int, int]] = set()
        for number, name in enumerate(self.names):
            parts = self._numbers_of(number, {at: self._changes({**values, name: at}) for at in TRIED})
            places = {(id(each.numbers), each.place) for each in parts or ()}
            if parts is None or places & taken:
                return None
            taken |= places
            found += parts
        return found

    def _numbers_of(
        self, number: int, tried: Mapping[float, dict[tuple[int, int], Change] | None]
    ) -> list[AffineNumber] | None:
        """Return the numbers that equal offset + slope * value at all tested values of an input, or None if any does not."""
        known = {value: changes for value, changes in tried.items() if changes is not None}
        if len(known) < len(tried):
            return None
        parts: list[AffineNumber] = []
        for at, force in {at: change for changes in known.values() for at, change in changes.items()}.items():
            if force.of_inputs:
                self._of_time.add(number)
            present = force.group.numbers[force.first :][: len(force.values)].copy()
            found = {value: changes[at].values if at in changes else present for value, changes in known.items()}
            offset, slope = found[0.0], found[1.0] - found[0.0]
            for value, numbers in found.items():
                if not np.allclose(numbers, offset + slope * value, rtol=SAME_NUMBER, atol=SAME_NUMBER * abs(value)):
                    return None
            parts += [
                AffineNumber(force.group.numbers, force.first + int(k), number, float(offset[k]), float(slope[k]))
                for k in np.flatnonzero(slope)
            ]
        return parts

    def _changes(self, values: Mapping[str, float]) -> dict[tuple[int, int], Change] | None:
        """Return the forces, by their places, that differ from the current ones for some values of the inputs."""
        try:
            found = changes_of_numbers(self._job, self._scene(values))
        except InputError:
            return None
        return None if found is None else {(id(change.group), change.number): change for change in found}


def _numbers(values: Any) -> np.ndarray:
    """Return values as an array of numbers; raise an InputError if they are none."""
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"inputs: found {values!r}, expected numbers") from None


def _number(value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"inputs: found {value!r}, expected a number") from None
