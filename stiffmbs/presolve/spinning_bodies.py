"""Removal of the spin about the symmetry axis from the quaternions of axisymmetric bodies.

A wheel's quaternion rotates with the wheel, and each turn requires integrator steps. If nothing depends on the spin
angle, the quaternion follows only the angular velocity across the axis, and the angle is a separate state. Forces are
unchanged. Constraints and the angular momentum, which are differentiated by time, follow the quaternion
(`stiffmbs.elements.spatial.forces.gyroscopic_torque`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..compile.kind import Compilable
from ..elements.element import Element
from ..reading.formula.formula import Formula
from ..reading.joint_name import JointName
from ..reading.marker import MarkerReference
from .relations import PRESOLVE

AXES = "xyz"


def spinning(model: Compilable, turns: Mapping[str, np.ndarray]) -> dict[str, str]:
    """Return the principal axes about which bodies spin, of those whose quaternions need not follow their spin.

    A body qualifies if its moments across the axis are equal and nothing that acts on it depends on its spin angle.
    Only elements that `stiffmbs.elements.element.Element.spins_with` allows may act on it: no angles, no joint that
    another element refers to. It must also rotate in a bearing, roll on a tyre, or spin at the start. `turns` of shape
    (3,): rotation of each body about its principal axes during the run at the initial angular velocity, rad.
    """
    found: dict[str, list[_Demand]] = {name: [] for name, body in model.bodies.items() if any(_symmetric_about(body))}
    if not found:
        return {}
    for _, element in model.elements():
        for marker, what, bears in _demands(element, model):
            body, placed = model.carried(marker)
            if body in found:
                found[body].append(_Demand(what, placed, bears))
    size = model.size()
    axes = {body: _axis(model.bodies[body], found[body], turns.get(body, np.zeros(3)), size) for body in found}
    return {body: axis for body, axis in axes.items() if axis}


REFUSED, POINT, BODY, ALONG = "", "point", "body", "along "
"""Requirements on a marker other than an axis (`stiffmbs.elements.element.Element.spins_with`)."""


class _Demand(NamedTuple):
    """Requirement of an element on a marker, and whether it lets the body rotate about the marker's axis."""

    what: str
    placed: Any
    bears: bool

    def met(self, axis: int, size: float) -> bool:
        """Return True if the body may spin about a principal axis."""
        if self.what in (REFUSED, BODY):
            return self.what == BODY
        from ..elements.spatial.orientation import matrix

        off_axis = np.abs(np.delete(np.array(self.placed.point), axis)).max()
        if not (self.what.startswith(ALONG) or off_axis <= PRESOLVE.alike * size):
            return False
        if self.what == POINT:
            return True
        tilt = np.abs(np.delete(matrix(self.placed.orientation)[:, AXES.index(self.what[-1])], axis)).max()
        return bool(tilt <= PRESOLVE.alike)


def _demands(element: Element, model: Compilable) -> Iterator[tuple[MarkerReference, str, bool]]:
    """Yield the markers that an element and its formulas use, with the requirement and whether it bears a spin."""
    allowed = element.spins_with()
    for field, marker in element.parts(MarkerReference):
        what = allowed.get(field, REFUSED)
        yield marker, what, what not in (REFUSED, POINT, BODY)
    referred = [joint.joint for _, joint in element.parts(JointName)]
    for _, formula in element.parts(Formula):
        referred += [joint for _, joint in formula.reactions()]
        for owner, coordinate in formula.coordinates():
            if owner in model.joints:
                referred.append(owner)
            else:
                seen = {"w": coordinate[1:], "q": REFUSED}.get(coordinate[0], BODY)  # wx requires the spin axis x
                yield MarkerReference(body=owner), seen, False
        for measure, (i, j, *axes) in formula.measures():
            # an angle forbids spin, and an angular velocity needs no point, nor an axis across the spin
            seen = {"a": REFUSED, "w": BODY}.get(measure[0], POINT)
            yield from ((marker, seen, False) for marker in (i, j))
            along = ALONG + measure[-1] if measure[0] == "w" else REFUSED
            yield from ((marker, along, False) for marker in axes)
    for joint in referred:
        yield from ((marker, REFUSED, False) for _, marker in model.joints[joint].parts(MarkerReference))


def _axis(body: object, demands: Sequence[_Demand], turns: np.ndarray, size: float) -> str:
    """Return the principal axis of a body's spin, or an empty string."""
    for k, (axis, symmetric) in enumerate(zip(AXES, _symmetric_about(body), strict=True)):
        if symmetric and all(demand.met(k, size) for demand in demands) and _is_spun(demands, turns, k):
            return axis
    return ""


def _symmetric_about(body: Any) -> tuple[bool, bool, bool]:
    """Return a mask of the principal axes with equal moments across."""
    x, y, z = body.principal_moments()
    return _alike(y, z), _alike(z, x), _alike(x, y)


def _alike(one: float, other: float) -> bool:
    return bool(abs(one - other) <= PRESOLVE.alike * max(one, other))


def _is_spun(demands: Sequence[_Demand], turns: np.ndarray, axis: int) -> bool:
    """Return True if an element bears a spin, or if the initial one is over a turn and the largest rotation."""
    across = [abs(turn) for k, turn in enumerate(turns) if k != axis]
    return any(demand.bears for demand in demands) or bool(abs(turns[axis]) > max(2 * np.pi, *across))
