"""In-place parameter change of a prepared job, to another model of the same structure or to other numbers."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..compile.group import Group
from ..compile.inputs.of_time import in_formulas_of_time
from ..compile.kind import sorted_out
from ..compile.system import System
from ..elements.element import Element
from ..elements.states.entry import StateValue
from ..errors import InputError, prefixed
from ..model.model_data import ModelData
from ..model.scene import Scene
from ..reading.did_you_mean import instead_of
from ..reading.formula.formula import Formula
from ..reading.formula.nodes import TIME
from ..reading.formula.text import FormulaError
from ..reading.marker import GROUND
from ..reading.table import Table
from .job import Job, prepare, start_of_job

HELD = ("dimensions", "gravity", "markers", "bodies", "joints")
"""Sections that must be equal: they determine coordinates, rank and the start."""


def renumbered(job: Job, data: ModelData) -> Job | None:
    """Return the job of a model that differs only in numbers of forces, or None if the model must be prepared again.

    The compiled system is changed in place: `job` must not be integrated again.  The start is assembled again, so that
    a run gives the same numbers as one of the separately prepared model.  Raise an AssemblyError if there is none.
    """
    if not write_numbers(job, data):
        return None
    job.dynamics.forget_pivots()  # a run must not depend on earlier ones
    changed = replace(job, data=data)
    return replace(changed, start=start_of_job(changed))


def write_numbers(job: Job, data: ModelData) -> bool:
    """Write the numbers of another model into the compiled forces of a job.

    Return False, with nothing changed, if the other model must be prepared again.
    """
    changes = changes_of_numbers(job, data)
    if changes is None:
        return False
    of_inputs = any(change.of_inputs for change in changes)
    for change in changes:
        change.write()
    job.dynamics.system.outputs.update(data.state_outputs())
    if of_inputs:
        job.dynamics.forget_inputs()
    return True


def changes_of_numbers(job: Job, data: ModelData) -> list[Change] | None:
    """Return the force changes from a job to another model, or None if that model must be prepared again."""
    system = job.dynamics.system
    if job.subsystems or not _same_structure(job.data, data):
        return None
    written = []
    placed = job.placed(data)
    for name, element in (*_changed(job.data, placed), *_changed_by_states(job.data, placed)):
        change = _change(system, name, element, data)
        if change is None:
            return None
        written.append(change)
    forces = ((job.data.forces[c.name], data.forces[c.name]) for c in written if c.name in data.forces)
    moved = any(list(before.markers()) != list(after.markers()) for before, after in forces)
    return None if moved and data.size() != system.size else written  # tolerances depend on the size


def _same_structure(before: ModelData, after: ModelData) -> bool:
    if type(before) is not type(after) or list(before.forces) != list(after.forces):
        return False
    if dict(before.angle_counters()).keys() != dict(after.angle_counters()).keys():
        return False
    if isinstance(before, Scene) and isinstance(after, Scene) and before.start != after.start:
        return False
    if not _same_states(before, after) and (_beginnings(before) != _beginnings(after) or _held_by_states(after)):
        return False
    return all(_same(getattr(before, section), getattr(after, section)) for section in HELD)


def _same(before: object, after: object) -> bool:
    if before is after:
        return True
    if isinstance(before, dict) and isinstance(after, dict):
        return list(before) == list(after) and all(_same(before[name], after[name]) for name in before)
    return bool(before == after)


def _same_states(before: ModelData, after: ModelData) -> bool:
    return _same(before.states, after.states) and _same(before.inputs, after.inputs)


def _beginnings(data: ModelData) -> dict[str, StateValue]:
    """Return the states without their formulas: initial values, scales of tolerances, kinds and times of samples."""
    return {name: replace(value, rate=None) for name, value in data.state_values().items()}


def _held_by_states(data: ModelData) -> bool:
    """Return True if the equations of a joint contain states or inputs."""
    return any(formula.states for joint in data.joints.values() for _, formula in joint.parts(Formula))


def _changed_by_states(before: ModelData, after: ModelData) -> Iterator[tuple[str, Element]]:
    """Yield the state equations, and unchanged forces whose formulas may contain states, outputs or inputs."""
    if _same_states(before, after):
        return
    yield from after.state_equations()
    for name, force in after.forces.items():
        if force is before.forces[name] and any(formula.states for _, formula in force.parts(Formula)):
            yield name, after.set_up(name, force)


def _changed(before: ModelData, after: ModelData) -> Iterator[tuple[str, Element]]:
    for name, force in after.forces.items():
        if force is not before.forces[name]:
            yield name, after.set_up(name, force)


def may_be_input(element: Element) -> bool:
    """Return True if an element has a table, or a formula of time."""
    if next(element.parts(Table), None):
        return True
    return any(
        part.id == TIME
        for _, formula in element.parts(Formula)
        for part in ast.walk(formula.tree)
        if isinstance(part, ast.Name)
    )


@dataclass(frozen=True)
class Change:
    """Replacement of an element of a group by one with other numbers.

    `of_inputs`: whether the old or the new element may have a formula or a table of time, or is an input in such formulas.
    """

    group: Group
    number: int
    element: Element
    first: int
    values: np.ndarray
    of_inputs: bool

    @property
    def name(self) -> str:
        """Name of the element."""
        return self.group.names[self.number]

    def write(self) -> None:
        """Write the numbers of the element into its group."""
        self.group.numbers[self.first : self.first + len(self.values)] = self.values
        self.group.elements[self.number] = self.element


def _change(system: System, name: str, force: Element, data: ModelData) -> Change | None:
    """Return the change of a force, or None if its equations, bodies or table lengths differ."""
    with prefixed(f"{name}: ", FormulaError):
        kind, found = sorted_out(name, force, data)
    group = next((group for group in system.groups if name in group.names), None)
    if group is None or kind != group.kind:
        return None
    element = group.names.index(name)
    index, values = group.index[element], found.flat()
    first = int(index[2 * kind.n_bodies])
    last = element + 1 == len(group.names)
    end = len(group.numbers) - 1 if last else int(group.index[element + 1, 2 * kind.n_bodies])
    bodies = [system.bodies[k] if k < len(system.bodies) else GROUND for k in group.bodies[element]]
    rows = index[2 * kind.n_bodies + 1 :][: kind.n_joints]
    joints = [system.equations[row][0] for row in rows]
    states = [system.states[k - system.first_state] for k in group.states[element]]
    if len(values) != end - first or bodies != found.bodies or joints != found.joints or states != found.states:
        return None
    of_inputs = may_be_input(force) or may_be_input(group.elements[element])
    of_inputs |= name in data.inputs and in_formulas_of_time(system, name)
    return Change(group, element, force, first, values, of_inputs)


def with_numbers(job: Job, name: str, **numbers: object) -> Job:
    """Return a job with changed parameters of a force, without a new compilation, examination or presolve.

    The model is prepared again only if its equations change, if the presolve solves mechanisms separately, or if it leaves
    out modes of flexible bodies.  The compiled system is changed in place, so `job` itself must not be integrated again.  Threads may run concurrently,
    each with its own job from `prepare`.

    Parameters
    ----------
    name : str
        Name of the force.
    **numbers
        Fields to change, in SI units: ``stiffness=300.0``, ``stiffness=[1e6, 1e6, 500.0]``.

    Raises
    ------
    InputError
        If there is no such force, or a field is unknown or out of bounds.
    AssemblyError
        If there is no consistent start with these numbers.

    Examples
    --------
    >>> job = prepare(scene, rtol=1e-8)
    >>> for k in np.linspace(200, 400, 1000):
    ...     job = with_numbers(job, "spring", stiffness=k)
    ...     ends.append(job.integrate().q[-1])
    """
    force = job.data.forces.get(name)
    if force is None:
        raise InputError(f"found no force '{name}'{instead_of(name, job.data.forces)}")
    with prefixed(f"{name}: "):
        changed = type(force)(**{**{field: getattr(force, field) for field in force.model_fields_set}, **numbers})
    data = job.data.model_copy(update={"forces": {**job.data.forces, name: changed}})
    return renumbered(job, data) or prepare(data, job.settings, job.start_from)
