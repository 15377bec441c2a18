"""Bodies that spin about an axis of symmetry: their quaternions are kept from spinning with them.

A wheel's quaternion turns as fast as the wheel does, and each turn costs an integrator steps.  Where nothing depends on the
angle of the spin, the quaternion follows the angular velocity across the axis alone, and the angle is a state of its own.
Forces stay as they are; what is differentiated by time, constraints and the angular momentum, follows the quaternion
(`stiffmbs.describe.spatial.forces.gyroscopic_torque`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..compile.kind import Compilable
from ..describe.element import Element, Joint
from ..describe.formula.formula import Formula
from ..describe.joint_name import JointName
from ..describe.marker import MarkerReference
from ..describe.states.name import StateName
from ..describe.states.state import StateValue

AXES = "xyz"
ALIKE = 1e-12
"""What both moments across the axis may differ by, relative to each other; and how far a marker may be beside the axis and
tilted against it, relative to the mechanism's size and to one."""
ANGLE = "spin_angle"
"""Behind a body's name: the name of its state."""


class SpinningBodies(NamedTuple):
    """A model some of whose quaternions don't follow the spin of their bodies.

    Attributes
    ----------
    model : Compilable
        As described, or with merged bodies.
    axes : mapping of str to str
        The principal axis that each of these bodies spins about, ``x``, ``y`` or ``z``.
    """

    model: Compilable
    axes: Mapping[str, str]

    @property
    def dimensions(self) -> int:
        """Of the model."""
        return self.model.dimensions

    @property
    def bodies(self) -> Mapping[str, Any]:
        """All bodies by name."""
        return self.model.bodies

    @property
    def joints(self) -> Mapping[str, Any]:
        """All joints by name."""
        return self.model.joints

    def joint_at_initial_pose(self, name: str) -> Joint:
        """Return a joint of the model."""
        return self.model.joint_at_initial_pose(name)

    def state_outputs(self) -> Mapping[str, Formula]:
        """The outputs that formulas use by a name."""
        return self.model.state_outputs()

    def state_values(self) -> dict[str, StateValue]:
        """The states of the model, and the angles of the spins, from zero on."""
        return {**self.model.state_values(), **{name_of_angle(body): StateValue(None, 0.0, 1.0) for body in self.axes}}

    def size(self) -> float:
        """That of the model."""
        return self.model.size()

    def carried(self, marker: Any) -> tuple[str, Any]:
        """The body that carries a marker, and where on it."""
        return self.model.carried(marker)

    def spin_axes(self) -> Mapping[str, str]:
        """The bodies whose quaternions don't follow their spin, with their axes."""
        return self.axes

    def elements(self) -> Iterator[tuple[str, Element]]:
        """Those of the model, and the rates of the angles."""
        from ..describe.spatial.spin_angle import SpinAngle

        yield from self.model.elements()
        for body, axis in self.axes.items():
            state, marker = StateName(name_of_angle(body)), MarkerReference(body=body)
            yield state, SpinAngle.model_construct(state=state, i=marker, axis=axis)  # type: ignore[arg-type]


def name_of_angle(body: str) -> str:
    """The state that holds the angle of a body's spin."""
    return f"{body}.{ANGLE}"


def spinning(model: Compilable, turns: Mapping[str, np.ndarray]) -> SpinningBodies | None:
    """The same model with quaternions that don't follow spins, if there is such a body.

    A body may spin so if its moments across the axis are equal, and all that acts on it stays the same as it turns: no element
    but those of `stiffmbs.describe.element.Element.spins_with`, no angle, no joint that another element refers to.  It does if
    it turns in a bearing or rolls on a tyre, or spins at the start.

    Parameters
    ----------
    model : Compilable
        In space or in the plane, where there is none.
    turns : mapping of str to ndarray, shape (3,)
        How far each body would turn about its principal axes in the run at the angular velocity of the start, rad.
    """
    if model.dimensions == 2:
        return None
    found: dict[str, list[_Demand]] = {name: [] for name, body in model.bodies.items() if any(_symmetric_about(body))}
    if not found:
        return None
    for _, element in model.elements():
        for marker, what, bears in _demands(element, model):
            body, placed = model.carried(marker)
            if body in found:
                found[body].append(_Demand(what, placed, bears))
    size = model.size()
    axes = {body: _axis(model.bodies[body], found[body], turns.get(body, np.zeros(3)), size) for body in found}
    spun = {body: axis for body, axis in axes.items() if axis}
    return SpinningBodies(model, spun) if spun else None


REFUSED, POINT, BODY = "", "point", "body"
"""Besides an axis what is asked of a marker on a body that spins (`stiffmbs.describe.element.Element.spins_with`)."""


class _Demand(NamedTuple):
    """What is asked of a marker that is placed on a body, and whether that lets the body turn about the marker's axis."""

    what: str
    placed: Any
    bears: bool

    def met(self, axis: int, size: float) -> bool:
        """Whether the body may spin about one of its principal axes."""
        if self.what in (REFUSED, BODY):
            return self.what == BODY
        beside = np.abs(np.delete(np.array(self.placed.point), axis)).max()
        return bool(beside <= ALIKE * size and (self.what == POINT or self._tilt(axis) <= ALIKE))

    def _tilt(self, axis: int) -> float:
        from ..describe.spatial.orientation import matrix

        along = matrix(self.placed.orientation)[:, AXES.index(self.what)]
        return float(np.abs(np.delete(along, axis)).max())


def _demands(element: Element, model: Compilable) -> Iterator[tuple[MarkerReference, str, bool]]:
    """The markers that an element uses, itself and in its formulas, what it asks of each, and whether it bears a spin."""
    allowed = element.spins_with()
    for field, marker in element.parts(MarkerReference):
        what = allowed.get(field, REFUSED)
        yield marker, what, what not in (REFUSED, POINT, BODY)
    referred = [joint.joint for _, joint in element.parts(JointName)]
    for _, formula in element.parts(Formula):
        referred += [joint for _, joint in formula.reactions()]
        for body, coordinate in formula.coordinates():
            yield MarkerReference(body=body), _seen_in_coordinate(coordinate), False
        for measure, (i, j, *axes) in formula.measures():
            yield from ((marker, _seen_in_measure(measure), False) for marker in (i, j))
            yield from ((marker, REFUSED, False) for marker in axes)
    for joint in referred:
        yield from ((marker, REFUSED, False) for _, marker in model.joints[joint].parts(MarkerReference))


def _seen_in_coordinate(name: str) -> str:
    """What a body's coordinate or velocity in a formula asks: wx, in the body's own axes, that these lie along the spin's."""
    return name[1] if name[0] == "w" else REFUSED if name[0] == "q" else BODY


def _seen_in_measure(name: str) -> str:
    """What a measure asks of its two markers: an angle sees the spin, an angular velocity needs no point."""
    return REFUSED if name[0] == "a" else BODY if name[0] == "w" else POINT


def _axis(body: Any, demands: Sequence[_Demand], turns: np.ndarray, size: float) -> str:
    """The principal axis that a body spins about; none for most bodies."""
    for k, (axis, symmetric) in enumerate(zip(AXES, _symmetric_about(body), strict=True)):
        if symmetric and all(demand.met(k, size) for demand in demands) and _is_spun(demands, turns, k):
            return axis
    return ""


def _symmetric_about(body: Any) -> tuple[bool, bool, bool]:
    """About which principal axes the moments across are equal."""
    x, y, z = body.principal_moments()
    return _alike(y, z), _alike(z, x), _alike(x, y)


def _alike(one: float, other: float) -> bool:
    return bool(abs(one - other) <= ALIKE * max(one, other))


def _is_spun(demands: Sequence[_Demand], turns: np.ndarray, axis: int) -> bool:
    """Whether something bears a spin of the body, or it spins from the start: a whole turn, and further than across."""
    across = [abs(turn) for k, turn in enumerate(turns) if k != axis]
    return any(demand.bears for demand in demands) or bool(abs(turns[axis]) > max(2 * np.pi, *across))
