"""Inputs of a simulation, whose values in forces and states change between steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..analyses.job import Job
from ..analyses.renumber import Change, changes_of_numbers, write_numbers
from ..dynamics.held_inputs import AffineNumber, HeldInputs
from ..errors import InputError
from ..model.scene import Scene
from ..reading.did_you_mean import instead_of
from .case_solver import CaseSolver

TRIED: Final = (0.0, *(sign * 10.0**k for k in (0, -1, 3) for sign in (1, -1)))
"""Values at which the linearity of force parameters in an input is tested."""
SAME_NUMBER = 8 * float(np.finfo(float).eps)


class InputNumbers:
    """Numbers of a compiled model that depend on inputs.

    `job`: job whose forces have the inputs. `solver`: solver of the scene with these inputs. `values`: inputs,
    parameters or paths of the scene, with their initial values. Raises InputError if an input changes more than numbers
    of forces and states.

    - `names`: names of the inputs, in their order.
    - `held`: their values, and the numbers that are affine functions of one.
    - `affine`: true if these are all numbers that depend on inputs; otherwise the scene is read again at each change.
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
        found = self._affine_numbers(values)
        self.affine = found is not None
        self.held = HeldInputs([*values.values()], found or ())

    def _scene(self, values: Mapping[str, float]) -> Scene:
        return self._solver.scene([float(values[name]) for name in self.names])

    @property
    def values(self) -> dict[str, float]:
        """Return the current values by name."""
        return dict(zip(self.names, self.held.values.tolist(), strict=True))

    def set(self, values: Mapping[str, float] | Sequence[float] | np.ndarray) -> bool:
        """Change inputs; return True if any of them has a new value.

        `values`: by name, others keep theirs; or all of them, in the order of `names`. Raises InputError, with nothing
        changed, if there is no such input, or a value is invalid or changes more than numbers of forces and states.
        """
        wanted = self.held.wanted
        try:
            self._fill(wanted, values)
        except (TypeError, ValueError):
            raise InputError(f"inputs: found {values!r}, expected numbers") from None
        if self.affine:
            changed = self.held.hold()
            if changed < 0:
                self.check_finite(wanted)
            return changed > 0
        self.check_finite(wanted)
        changed = {
            name: new
            for name, new, old in zip(self.names, wanted.tolist(), self.held.values.tolist(), strict=True)
            if new != old
        }
        if changed:
            self._write(changed)
            self.held.values[:] = wanted
        return bool(changed)

    def _fill(self, wanted: np.ndarray, values: Mapping[str, float] | Sequence[float] | np.ndarray) -> None:
        """Fill an array with all inputs; those that are not given keep their values."""
        if isinstance(values, np.ndarray) and values.shape == wanted.shape:
            wanted[:] = values
        elif isinstance(values, Mapping):
            wanted[:] = self.held.values
            for name, value in values.items():
                if name not in self._places:
                    raise InputError(f"input '{name}': found no such input{instead_of(name, self._places)}")
                wanted[self._places[name]] = value
        else:
            self.check_shape(values, ())
            wanted[:] = values

    def check_shape(self, values: object, rows: tuple[int, ...]) -> None:
        """Raise an InputError if values are no array of numbers, one for each input, with these rows."""
        shape, expected = np.shape(values), (*rows, len(self.names))  # type: ignore[arg-type]
        if shape != expected:
            raise InputError(
                f"inputs: found an array of shape {shape}, expected {expected}, one column for each of {', '.join(self.names) or 'no inputs'}"
            )

    def check_finite(self, values: np.ndarray) -> None:
        """Raise an InputError that names the first input without a finite value."""
        bad = np.argwhere(~np.isfinite(values))
        if len(bad):
            at = tuple(bad[0].tolist())
            row = f" in row {at[0]}" if len(at) > 1 else ""
            raise InputError(f"input '{self.names[at[-1]]}': found {values[at]}{row}, expected a finite number")

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
                return None
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
