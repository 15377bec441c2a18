"""Bodies connected by fixed joints: merged before the equations are compiled, and recovered afterwards."""

from __future__ import annotations

from collections.abc import Container, Iterator
from typing import Any

from ..model.model_data import ModelData
from ..reading.formula.formula import Formula
from ..reading.joint_name import JointName
from ..reading.marker import GROUND, MarkerReference
from .reduced_model import ReducedModel, geometry

FIXED = "fixed"
"""Kind of fixed joints."""


def merge(model: ModelData, held: Container[str]) -> ReducedModel:
    """Merge the bodies connected by fixed joints.

    Bodies with coordinates named in a formula are kept separate. So are bodies between which a force or another joint
    acts, and those of a joint to which another element refers. `held`: joints without redundant equations, as a merged
    joint must not constrain more than the original.
    """
    if not any(joint.kind == FIXED for joint in model.joints.values()):
        return ReducedModel(model, model.bodies)
    joints = [name for name in _candidates(model) if name in held]
    groups = _Groups(model)
    used = [name for name in joints if groups.join(name)]
    bodies: dict[str, object] = {}
    members: dict[str, tuple[str, object]] = {}
    for first, placements in groups.placements.items():
        if len(placements) == 1:
            bodies[first] = model.bodies[first]
            continue
        parts = [(model.bodies[name], placed) for name, placed in placements.items()]
        bodies[first], places = groups.geometry.composite(parts)
        members |= {name: (first, placed) for name, placed in zip(placements, places, strict=True)}
    return ReducedModel(model, bodies, members, tuple(used))


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


class _Groups:
    """Groups of merged bodies, each with the placements of its members on the first."""

    def __init__(self, model: ModelData) -> None:
        self._model = model
        self.geometry = geometry(model.dimensions)
        self.placements: dict[str, dict[str, Any]] = {
            body: {body: self.geometry.Placement.model_construct()} for body in model.bodies
        }
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
