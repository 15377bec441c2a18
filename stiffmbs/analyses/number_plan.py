"""Mapping of the values of a study to the compiled numbers of a job, of which each case changes a few in place.

The forces are read once with tracked numbers (`stiffmbs.describe.files.followed`).  If a comparison of these has
another result with other values, the whole scene of the case is read: it has other equations or is invalid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..compile.kind import sorted_out
from ..describe.element import Element
from ..describe.files.followed import Followed, Record
from ..describe.files.other_forces import OtherForces
from ..describe.model_data import ModelData
from ..describe.scene import Scene, notes_of
from ..describe.settings import SteadyMotion
from ..errors import StiffmbsError
from .job import Job, start_of_job
from .renumber import may_be_input, renumberable


@dataclass(frozen=True)
class _Numbers:
    """Numbers of a force in its group.

    Attributes
    ----------
    now : ndarray
        Numbers that compiled code reads.
    fixed : ndarray
        Their values, except for those that depend on the case.
    slots, places : ndarrays of int
        Indices of the numbers that depend on the case, in `now` and in the record.
    """

    now: np.ndarray
    fixed: np.ndarray
    slots: np.ndarray
    places: np.ndarray

    def write(self, numbers: np.ndarray) -> None:
        self.now[:] = self.fixed
        self.now[self.slots] = numbers[self.places]


@dataclass(frozen=True)
class NumberPlan:
    """Plan by which the values of a case are written into a job.

    Attributes
    ----------
    job : Job
        Job whose compiled system is changed.  The forces in its data have the values of no case.
    forces : OtherForces
    record : Record
    like : tuple
        Types of the values: numbers, or lists of numbers of a given length.
    numbers : tuple of _Numbers
    of_inputs : bool
        True if the forces contain formulas or tables of time.
    """

    job: Job
    forces: OtherForces
    record: Record
    like: tuple[Any, ...]
    numbers: tuple[_Numbers, ...]
    of_inputs: bool

    def with_values(self, values: Sequence[Any]) -> Job | None:
        """Return the job of a case, or None if its whole scene must be read.

        The compiled system is changed in place, as by `stiffmbs.analyses.renumber.renumbered`.

        Raises
        ------
        AssemblyError
            If there is no consistent start with these values.
        """
        if tuple(map(_like, values)) != self.like:
            return None
        try:
            found = self.record.numbers(values, self.forces.parameters(values))
        except (StiffmbsError, ValueError, ArithmeticError):
            return None
        if found is None:
            return None
        numbers = np.array(found, dtype=float)
        for each in self.numbers:
            each.write(numbers)
        if self.of_inputs:
            self.job.dynamics.forget_inputs()
        self.job.dynamics.forget_pivots()
        return replace(self.job, start=start_of_job(self.job))


def number_plan(job: Job, forces: OtherForces, values: Sequence[Any]) -> NumberPlan | None:
    """Return the plan by which other values are written into a job, or None if the scene of each case must be read.

    Parameters
    ----------
    job : Job
        Job of the scene that was read as a whole with these values.
    forces : OtherForces
    values : sequence
    """
    like = tuple(map(_like, values))
    if None in like or not renumberable(job) or not isinstance(job.data, Scene) or _starts_by_forces(job.data):
        return None
    followed = forces.followed(values)
    if followed is None:
        return None
    record, scene = followed
    try:
        numbers = [_numbers(job, scene, name, record, values, forces) for name in forces.affected]
        if notes_of(scene) != notes_of(job.data):
            return None
    except Exception:  # an element's code may raise any exception for a tracked number
        return None
    known = [each for each in numbers if each is not None]
    if len(known) < len(numbers):
        return None
    record.close()
    of_inputs = any(may_be_input(scene.forces[name]) for name in forces.affected)
    return NumberPlan(replace(job, data=scene), forces, record, like, tuple(known), of_inputs)


def _starts_by_forces(scene: Scene) -> bool:
    """Return True if the start may depend on the described forces."""
    return bool(scene.at_start) or isinstance(scene.start, SteadyMotion)


def _like(value: Any) -> Any:
    """Return the type of a number or of a list of numbers, or None for other values."""
    if isinstance(value, list | tuple):
        parts = tuple(map(_like, value))
        return None if None in parts else parts
    return float if type(value) in (int, float) else None


def _numbers(
    job: Job, scene: Scene, name: str, record: Record, values: Sequence[Any], forces: OtherForces
) -> _Numbers | None:
    """Return the location of the numbers of a force, or None if the force differs when its numbers are tracked."""
    system, (force, as_read) = job.dynamics.system, (_placed(data, name) for data in (scene, job.data))
    group = next((group for group in system.groups if name in group.names), None)
    if group is None or _markers(force) != _markers(as_read):
        return None
    (kind, found), (kind_as_read, expected) = sorted_out(name, force, scene), sorted_out(name, as_read, job.data)
    alike = (kind, found.bodies, found.joints, found.states, len(found.numbers), len(found.tables)) == (
        kind_as_read, expected.bodies, expected.joints, expected.states, len(expected.numbers), len(expected.tables)
    )  # fmt: skip
    known = record.numbers(values, forces.parameters(values))
    if not alike or known is None:
        return None
    slots = [k for k, number in enumerate(found.numbers) if isinstance(number, Followed)]
    places = [found.numbers[k].place for k in slots]
    first, fixed = int(group.index[group.names.index(name)][2 * kind.n_bodies]), expected.flat()
    now = group.numbers[first : first + len(fixed)]
    again = [known[number.place] if isinstance(number, Followed) else number for number in found.numbers]
    if kind != group.kind or again != expected.numbers or not np.array_equal(now, fixed):
        return None
    return _Numbers(now, fixed, np.array(slots, dtype=np.int64), np.array(places, dtype=np.int64))


def _placed(data: ModelData, name: str) -> Element:
    force: Element = data.forces[name].at_initial_pose(data)
    return force


def _markers(element: Element) -> list[Any]:
    return [marker for _, marker in element.markers()]
