"""Derivatives of the set-up of a run by a parameter: numbers of elements, masses, the start, breakpoints.

The equations of motion are differentiated exactly.  The set-up is arithmetic and an assembly, both exact to rounding;
it is differentiated by central differences.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...analyses.job import Job, start_of_job
from ...analyses.start_from import started_from
from ...compile.compile_model import compile_model
from ...compile.directional.direction import Numbers
from ...compile.inputs.features import input_features
from ...compile.kind import sorted_out
from ...compile.system import System
from ...dynamics.dynamics import Dynamics
from ...elements.element import Element
from ...errors import InputError, SolverError
from ...model.model_data import ModelData
from ...model.scene import Scene
from ...results.scales import ROUNDING
from ...sensitivity_equations.jumps import BreakpointRates
from .parameters import Parameter

HELD = ("dimensions", "gravity", "markers", "states", "inputs", "roads")
"""Sections on which every element may depend."""


class SetUp:
    """Derivatives of the set-up of a job by one parameter.

    `job`: job of the unchanged scene. Raises InputError if the parameter changes the structure of the model, or neither
    a larger nor a smaller value is valid.
    """

    def __init__(self, job: Job, parameter: Parameter) -> None:
        self._job, self.parameter = job, parameter
        self.scenes, self.shifts, self._weights = self._differences()
        self._quick = all(_same_bodies(job.data, scene) for scene in self.scenes)

    def _differences(self) -> tuple[list[Scene], list[float], list[float]]:
        """Return scenes with other values, their shifts, and the weights of their results in the derivative."""
        value, step = self.parameter.value, self.parameter.step
        faults: list[InputError] = []
        for shifts, weights in (
            ((-1.0, 1.0), (-0.5, 0.5)),
            ((0.0, 1.0, 2.0), (-1.5, 2.0, -0.5)),
            ((0.0, -1.0, -2.0), (1.5, -2.0, 0.5)),
        ):
            try:
                scenes = self._scenes([value + shift * step for shift in shifts])
                return scenes, [shift * step for shift in shifts], [weight / step for weight in weights]
            except InputError as error:
                faults.append(error)
        raise InputError(f"to: found that '{self.parameter.name}' cannot be changed a little: {faults[0]}")

    def _scenes(self, values: Sequence[float]) -> list[Scene]:
        """Return scenes with other values, whose flexible bodies have the same modes. Raises InputError."""
        found = [self.parameter.scene(value) for value in values]
        if not self._job.dynamics.system.has_coupled_inertia:
            return found
        from ...model.flexible import with_same_modes

        return with_same_modes(found, self._job.data)

    def derivative(self, values: Sequence[object]) -> np.ndarray:
        """Return the derivative from the results of the scenes."""
        return np.asarray(sum(w * np.asarray(value) for w, value in zip(self._weights, values, strict=True)))

    @cached_property
    def _systems(self) -> list[System]:
        """Compiled systems of the scenes."""
        placed = [self._job.placed(scene) for scene in self.scenes]
        found = [started_from(compile_model(scene), scene, self._job.start_from) for scene in placed]
        system = self._job.dynamics.system
        for other in found:
            if not _same_structure(system, other):
                without = any(any(scene.gravity) for scene in self.scenes) and not any(self._job.data.gravity)
                raise InputError(
                    f"to: found that '{self.parameter.name}' changes the structure of the model"
                    f"{' (no body has a weight where gravity is zero)' if without else ''}, expected one that changes values only"
                )
            if not np.array_equal(system.principal_axes, other.principal_axes):
                raise InputError(
                    f"to: found that '{self.parameter.name}' turns principal axes of a body, expected inertias about fixed ones"
                )
        return found

    @cached_property
    def numbers(self) -> Numbers:
        """Return the derivatives of the system's numbers."""
        system = self._job.dynamics.system
        if self._quick:
            of_groups, mass = self._numbers_of_changed(), np.zeros(system.n_u)
        else:
            of_groups = [
                self.derivative(parts)
                for parts in zip(*([g.numbers for g in s.groups] for s in self._systems), strict=True)
            ]
            mass = self.derivative([other.mass for other in self._systems])
        moved = frozenset(g for g, numbers in enumerate(of_groups) if numbers.any())
        return Numbers(tuple(map(np.ascontiguousarray, of_groups)), moved, mass)

    def _numbers_of_changed(self) -> list[np.ndarray]:
        """Return the derivatives for changed elements, and for elements that may refer to changed joints."""
        job, system = self._job, self._job.dynamics.system
        found = [np.zeros_like(group.numbers) for group in system.groups]
        joints = self._changed("joints")
        for section, names in (
            ("joints", job.data.joints if joints else joints),
            ("forces", job.data.forces if joints else self._changed("forces")),
        ):
            for name in names:
                places = [self._place(name, scene, getattr(scene, section)[name]) for scene in self.scenes]
                g, first, values = places[0]
                if any(not np.array_equal(other, values) for _, _, other in places):
                    found[g][first : first + len(values)] = self.derivative([values for _, _, values in places])
        return found

    def _changed(self, section: str) -> list[str]:
        """Return the names of the elements that are not those of the job's own scene."""
        before = getattr(self._job.data, section)
        return [
            name for name in before if any(getattr(scene, section)[name] is not before[name] for scene in self.scenes)
        ]

    def _place(self, name: str, scene: Scene, element: Element) -> tuple[int, int, np.ndarray]:
        """Return the group of an element, the index of its first number there, and its numbers."""
        kind, data = sorted_out(name, self._job.placed(scene).set_up(name, element), scene)
        for g, group in enumerate(self._job.dynamics.system.groups):
            if name in group.names and group.kind == kind:
                return g, int(group.index[group.names.index(name), 2 * kind.n_bodies]), data.flat()
        raise InputError(
            f"to: found that '{self.parameter.name}' changes the equations of '{name}', expected a parameter that changes numbers"
        )

    @cached_property
    def start(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of q and u at the start, shapes (n_q,), (n_u,)."""
        system, numbers = self._job.dynamics.system, self.numbers
        if self._quick and not self._start_follows(numbers):
            return np.zeros(system.n_q), np.zeros(system.n_u)
        if self._described and not (system.n_c or system.n_counters or system.algebraic.any()):  # no assembly
            return self.derivative([s.q for s in self._systems]), self.derivative([s.u for s in self._systems])
        others = [Dynamics(replace(other, active=system.active)) for other in self._systems]
        starts = [
            start_of_job(replace(self._job, data=scene, dynamics=dynamics))
            for scene, dynamics in zip(self.scenes, others, strict=True)
        ]
        return self.derivative([start.q for start in starts]), self.derivative([start.u for start in starts])

    def _start_follows(self, numbers: Numbers) -> bool:
        """Return True if the start may change although the described bodies do not."""
        if not self._described:
            return True
        groups = self._job.dynamics.system.groups
        return any(groups[g].record.n_equations or groups[g].record.n_counters for g in numbers.moved)

    @property
    def _described(self) -> bool:
        """Return True if a run starts as described, apart from the projection onto the constraints."""
        return bool(getattr(self._job.data, "start", "described") == "described")

    def has_breakpoint(self, t: float) -> bool:
        """Return True if an input has a breakpoint at t; a run also restarts for narrow features of laws."""
        return bool(self._near(t).any())

    def _near(self, t: float) -> np.ndarray:
        return np.abs(self._breakpoints[0] - t) <= ROUNDING * (self._job.grid.end - self._job.grid.start)

    def breakpoint_rate(self, t: float, needed: bool) -> float:
        """Return the derivative of the breakpoint in time at t.

        Raises SolverError if it is required, and other values have no such breakpoint.
        """
        known, *others = self._breakpoints
        place = int(np.flatnonzero(self._near(t))[0])
        there = [_counterpart(known, place, other) for other in others]
        if None not in there:
            return float(self.derivative(there))
        if not needed:
            return 0.0
        raise SolverError(
            f"sensitivities: found {len(known)} breakpoints of inputs, and {[len(o) for o in others]} for other values of "
            f"'{self.parameter.name}', so that the motion is not differentiable with respect to it; expected the same number"
        )

    @cached_property
    def _breakpoints(self) -> list[np.ndarray]:
        start, end = self._job.grid.start, self._job.grid.end
        systems = [self._job.dynamics.system, *self._systems]
        return [np.asarray(input_features(system, start, end).breakpoints) for system in systems]


def breakpoint_rates(set_ups: Sequence[SetUp]) -> BreakpointRates:
    """Return a function for the derivative of the breakpoint near a given time by each parameter."""

    def rates(t: float, needed: bool) -> np.ndarray | None:
        if not set_ups[0].has_breakpoint(t):
            return None
        return np.array([each.breakpoint_rate(t, needed) for each in set_ups])

    return rates


def _counterpart(known: np.ndarray, place: int, other: np.ndarray) -> float | None:
    """Return the breakpoint for another value that corresponds to a known one, or None if this is ambiguous.

    Breakpoints may enter or leave at the ends of the run, so their number may differ.
    """
    if len(known) == len(other):
        return float(other[place])
    nearest = int(np.argmin(np.abs(other - known[place]))) if len(other) else None
    if nearest is None or int(np.argmin(np.abs(known - other[nearest]))) != place:
        return None
    return float(other[nearest])


def _same_bodies(before: ModelData, after: ModelData) -> bool:
    """Return True if all but joints and forces is equal, so that elements can be compared one by one."""
    if any(getattr(before, section, None) != getattr(after, section, None) for section in HELD):
        return False
    if list(before.bodies) != list(after.bodies) or list(before.forces) != list(after.forces):
        return False
    return all(body is after.bodies[name] or body == after.bodies[name] for name, body in before.bodies.items())


def _same_structure(a: System, b: System) -> bool:
    return (
        a.bodies == b.bodies and a.states == b.states and len(a.groups) == len(b.groups)
        and all(
            x.kind == y.kind and x.names == y.names and x.numbers.shape == y.numbers.shape
            for x, y in zip(a.groups, b.groups, strict=True)
        )
    )  # fmt: skip
