"""Bodies connected by fixed joints: merged before the equations are compiled, and recovered afterwards."""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any

from ..compile.kind import ChangedModel
from ..elements.element import Element
from ..elements.states.state import StateValue
from ..model.model_data import ModelData
from ..reading.formula.formula import Formula
from ..reading.joint_name import JointName
from ..reading.marker import GROUND, MarkerReference

FIXED = "fixed"
"""Kind of fixed joints."""


@dataclass(frozen=True)
class MergedBodies(ChangedModel):
    """Model with merged bodies in place of those connected by fixed joints.

    - `model`: as described.
    - `bodies`: merged bodies, with the total mass, centre of mass and inertia of the members, named after the first.
    - `members`: merged body of each body of the model, and the placement of its centre of mass and axes on that.
    - `joints_left_out`: fixed joints within merged bodies.
    """

    model: ModelData
    bodies: dict[str, Any]
    members: dict[str, tuple[str, Any]]
    joints_left_out: tuple[str, ...]

    def state_values(self) -> dict[str, StateValue]:
        """Return the values of all states."""
        return self.model.state_values()

    def spin_axes(self) -> dict[str, str]:
        """Return no axes."""
        return {}

    def elements(self) -> Iterator[tuple[str, Element]]:
        """Yield the elements that act on the merged bodies, with weights, counters of rotations and state equations."""
        for name, element in self.model.elements_at_initial_pose():
            if name not in self.joints_left_out:
                yield name, element
        yield from self.model.angle_counters()
        yield from self.model.state_equations()
        yield from self.model.inertial(self.bodies)

    def carried(self, marker: MarkerReference) -> tuple[str, object]:
        """Return the merged body that carries a marker, and the marker's placement on it."""
        body, placed = self.model.carried(marker)
        if body == GROUND:
            return body, placed
        parent, member = self.members[body]
        return parent, _geometry(self.dimensions).on(member, placed)


def merge(model: ModelData, held: Container[str]) -> MergedBodies | None:
    """Merge the bodies connected by fixed joints.

    Bodies with coordinates named in a formula are kept separate. So are bodies between which a force or another joint
    acts, and those of a joint to which another element refers. `held`: joints without redundant equations, as a merged
    joint must not constrain more than the original. The result: none if there is nothing to merge.
    """
    if not any(joint.kind == FIXED for joint in model.joints.values()):
        return None
    joints = [name for name in _candidates(model) if name in held]
    groups = _Groups(model)
    used = [name for name in joints if groups.join(name)]
    if not used:
        return None
    bodies: dict[str, object] = {}
    members: dict[str, tuple[str, object]] = {}
    for first, placements in groups.placements.items():
        if len(placements) == 1:
            bodies[first], members[first] = model.bodies[first], (first, *placements.values())
            continue
        parts = [(model.bodies[name], placed) for name, placed in placements.items()]
        bodies[first], places = groups.geometry.composite(parts)
        members |= {name: (first, placed) for name, placed in zip(placements, places, strict=True)}
    return MergedBodies(model, bodies, members, tuple(used))


def _candidates(model: ModelData) -> Iterator[str]:
    elements = [*model.joints.values(), *model.forces.values(), *(element for _, element in model.state_equations())]
    referred = {name.joint for element in elements for _, name in element.parts(JointName)}
    referred |= {joint for e in elements for _, formula in e.parts(Formula) for _, joint in formula.reactions()}
    named = {body for e in elements for _, formula in e.parts(Formula) for body, _ in formula.coordinates()}
    for name, joint in model.joints.items():
        bodies = {marker.body for _, marker in joint.markers()}
        apart = {GROUND, *named, *(body for body in bodies - {GROUND} if not model.bodies[body].rigid)}
        if joint.kind == FIXED and name not in referred and not bodies & apart:
            yield name


def _geometry(dimensions: int) -> ModuleType:
    """Return the module of placements for the plane or for space."""
    return import_module(f".{'planar' if dimensions == 2 else 'spatial'}_composite", __package__)


class _Groups:
    """Groups of merged bodies, each with the placements of its members on the first."""

    def __init__(self, model: ModelData) -> None:
        self._model = model
        self.geometry = _geometry(model.dimensions)
        self.placements: dict[str, dict[str, Any]] = {body: {body: self.geometry.Placement()} for body in model.bodies}
        self._first = {body: body for body in model.bodies}
        acting = [*model.joints.items(), *model.forces.items()]
        self._acts_between = [(name, {marker.body for _, marker in element.markers()}) for name, element in acting]

    def join(self, name: str) -> bool:
        """Merge the groups on both sides of a fixed joint; return False if something else acts between them."""
        joint = self._model.joints[name]
        (body_i, on_i), (body_j, on_j) = (self._model.carried(marker) for _, marker in joint.parts(MarkerReference))
        first, second = self._first[body_i], self._first[body_j]
        mine, other = self.placements[first], self.placements[second]
        if first == second or any(
            between & mine.keys() and between & other.keys() for n, between in self._acts_between if n != name
        ):
            return False
        on, inverse = self.geometry.on, self.geometry.inverse
        at = on(on(mine[body_i], on_i), inverse(on(other[body_j], on_j)))
        for member, placed in other.items():
            mine[member], self._first[member] = on(at, placed), first
        del self.placements[second]
        return True
