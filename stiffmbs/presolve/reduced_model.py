"""Model with fewer bodies and coordinates, and the record from which those of the described model are recovered."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from types import ModuleType
from typing import Any

from ..elements.element import Element, Joint
from ..elements.states.entry import StateValue
from ..elements.states.state_name import StateName
from ..model.model_data import ModelData
from ..reading.formula.formula import Formula
from ..reading.marker import MarkerReference

ANGLE = "spin_angle"
"""Suffix of a body's name for the name of the state with its spin angle."""


@dataclass(frozen=True)
class ReducedModel:
    """Model that is compiled in place of a described one; `presolve.Part` recovers the bodies of the latter.

    - `model`: as described.
    - `bodies`: bodies to solve for. Those connected by fixed joints are merged into one, named after the first.
    - `members`: merged body of each body within one, and the placement of its centre of mass and axes on that.
    - `joints_left_out`: fixed joints within merged bodies.
    - `axes`: principal axis, ``x``, ``y`` or ``z``, of the bodies whose quaternions exclude their spin, which is a state.
    """

    model: ModelData
    bodies: Mapping[str, Any]
    members: Mapping[str, tuple[str, Any]] = field(default_factory=dict)
    joints_left_out: tuple[str, ...] = ()
    axes: Mapping[str, str] = field(default_factory=dict)

    @property
    def dimensions(self) -> int:
        """Dimensions of the model."""
        return self.model.dimensions

    @property
    def joints(self) -> Mapping[str, Joint]:
        """All joints by name."""
        return self.model.joints

    def joint_at_initial_pose(self, name: str, reader: str = "") -> Joint:
        """Return a joint of the model."""
        return self.model.joint_at_initial_pose(name, reader)

    def state_outputs(self) -> Mapping[str, Formula]:
        """Return the outputs that formulas use by a name."""
        return self.model.state_outputs()

    def size(self) -> float:
        """Return the size of the model as described, m."""
        return self.model.size()

    def state_values(self) -> dict[str, StateValue]:
        """Return the values of the states of the model, and of the spin angles, which start at zero."""
        return self.model.state_values() | {name_of_angle(body): StateValue(None, 0.0, 1.0) for body in self.axes}

    def spin_axes(self) -> Mapping[str, str]:
        """Return the axes of the bodies whose quaternions exclude their spin."""
        return self.axes

    def elements(self) -> Iterator[tuple[str, Element]]:
        """Yield the elements that act on the solved bodies, with weights, counters, state equations and rates of spins."""
        for name, element in self.model.elements_at_initial_pose():
            if name not in self.joints_left_out:
                yield name, element
        yield from self.model.angle_counters()
        yield from self.model.state_equations()
        yield from self.model.inertial(self.bodies)
        if self.axes:
            yield from self._rates_of_spins()

    def _rates_of_spins(self) -> Iterator[tuple[str, Element]]:
        from ..elements.states.equation import SpinAngle

        for body, axis in self.axes.items():
            state, marker = StateName(name_of_angle(body)), MarkerReference.model_construct(body=body)
            yield state, SpinAngle.model_construct(state=state, i=marker, axis=axis)  # type: ignore[arg-type]

    def carried(self, marker: MarkerReference) -> tuple[str, object]:
        """Return the solved body that carries a marker, and the marker's placement on it."""
        body, placed = self.model.carried(marker)
        if body not in self.members:
            return body, placed
        parent, member = self.members[body]
        return parent, geometry(self.dimensions).on(member, placed)

    def on_parent(self, body: str) -> tuple[str, Any]:
        """Return the solved body that carries a body, and the placement of the latter on it."""
        return self.members.get(body) or (body, geometry(self.dimensions).Placement.model_construct())


def geometry(dimensions: int) -> ModuleType:
    """Return the module of placements for the plane or for space."""
    return import_module(f".{'planar' if dimensions == 2 else 'spatial'}_composite", __package__)


def name_of_angle(body: str) -> str:
    """Return the name of the state that holds the spin angle of a body."""
    return f"{body}.{ANGLE}"
