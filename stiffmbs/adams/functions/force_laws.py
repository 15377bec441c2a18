"""Forces of elements in the expressions of other forces: laws of positions and velocities are substituted for them.

SFORCE(id, jflag, comp, rm) and alike for SPDP, BUSH, VFORCE, VTORQ and GFORCE, and FX(i, j, rm) and alike of these and of
joints. The torque of a BUSHING, and elements whose force is not an expression, are not supported.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...reading.files.quoted import quoted
from ..scene.mechanism import Mechanism, Place
from ..statements.constraints import TRANSLATIONAL, Primitive
from ..statements.declared import Numbered
from ..statements.elastic import Bushing, SpringDamper
from ..statements.forces import SingleForce, VectorForce
from .acting import acting_between, element_of
from .function import Function
from .measures import BY_ITS_PLACE, component_of, reaction
from .trees import call, difference, magnitude, measured, number, over, product, quotient, times, total

if TYPE_CHECKING:
    from .translate import Translation

LAWS = {
    "SFORCE": "SFORCE", "VFORCE": "VFORCE", "VTORQ": "VTORQUE", "VTORQUE": "VTORQUE", "GFORCE": "GFORCE",
    "SPDP": "SPRINGDAMPER", "BUSH": "BUSHING",
}  # fmt: skip
"""Statements of the force functions whose laws are substituted."""


@dataclass(frozen=True)
class _Part:
    """Part of a force or torque: its size, along the line from one marker to another or along an axis of the ground."""

    size: ast.expr
    start: str = ""
    end: str = ""
    length: ast.expr | None = None
    axis: str = ""

    def along(self, axis: str, frame: Place | None, mechanism: Mechanism) -> ast.expr:
        """Return the component along an axis of a marker; of ground without one."""
        if not self.axis:
            displacement = measured(f"d{axis}", self.end, self.start, frame.reference if frame else "")
            return product(self.size, quotient(displacement, self.length) if self.length else displacement)
        if frame is None:
            return self.size if axis == self.axis else number(0.0)
        return product(self.size, measured(f"d{self.axis}", mechanism.tip(frame, axis), frame.reference, ""))


def force_by_law(name: str, arguments: list[ast.expr], function: Function, translation: Translation) -> ast.expr:
    """Return JOINT, SFORCE(id, jflag, comp, rm) and alike: a component of a force on marker I or J, in the dataset's units.

    Raises DatasetFault if there is no such statement, or it has no law of positions and velocities.
    """
    mechanism = translation.mechanism
    ident, on_j, component, axes = function.identifiers(arguments, 4)
    found = element_of(name, LAWS.get(name, name), ident, function, mechanism)
    if found is None:
        return number(0.0)
    frame = mechanism.place(axes, function, "RM") if axes else None
    which = component_of(name, component, function)
    return over(_component(found, bool(on_j), which, frame, function, translation), translation.force_unit(which))


def force_between(name: str, arguments: list[ast.expr], function: Function, translation: Translation) -> ast.expr:
    """Return FX(i, j, rm) and alike: the sum of what acts between two markers, in the dataset's units.

    Raises DatasetFault if nothing acts there, or an element that is neither a joint nor has a law.
    """
    mechanism = translation.mechanism
    i, j, axes = (*function.identifiers(arguments), 0, 0)[:3]
    acting = acting_between(i, j, function, mechanism)
    if not acting:
        return number(0.0)
    frame = mechanism.place(axes, function, "RM") if axes else None

    def along(component: str) -> ast.expr:
        return total([_component(found, on_j, component, frame, function, translation) for found, on_j in acting])

    several = name[1] == "M" and len(acting) > 1
    value = magnitude(along(name[0] + axis) for axis in "XYZ") if several else along(name)
    return over(value, translation.force_unit(name))


def _component(
    found: Numbered, on_j: bool, component: str, frame: Place | None, function: Function, translation: Translation
) -> ast.expr:
    """Return a component of the force of an element on marker I or J, N or N m."""
    mechanism = translation.mechanism
    if isinstance(found, Primitive):
        if found.kind in BY_ITS_PLACE:
            raise function.fault(f"found the reaction of {found.label}, {found.kind}, expected it in a REQUEST only")
        return reaction(found, component, on_j, frame, mechanism)
    if found.keyword not in LAWS.values():
        raise function.fault(
            f"found the force of {found.label} in '{quoted(function.text)}', expected it in a REQUEST, or that of a joint, or of "
            f"{', '.join(dict.fromkeys(LAWS.values()))}"
        )
    if found.label in translation.substituted:
        raise function.fault(
            f"found the force of {found.label} in its own law, expected forces that do not depend on themselves"
        )
    translation.substituted.append(found.label)
    try:
        parts = list(_parts(found, component[0], function, translation))
    finally:
        translation.substituted.pop()
    if not parts or (on_j and isinstance(found, SingleForce) and found.action_only):
        return number(0.0)
    if component[1] == "M":
        sizes = [part.size for part in parts]
        return call("abs", *sizes) if len(sizes) == 1 else magnitude(sizes)
    value = total([part.along(component[1].lower(), frame, mechanism) for part in parts])
    return times(value, -1.0) if on_j else value


def _parts(found: Numbered, kind: str, function: Function, translation: Translation) -> Iterator[_Part]:
    """Yield the parts of the force ('F') on marker I or of the torque ('T') about it, N or N m."""
    mechanism, unit = translation.mechanism, translation.force_unit(kind)
    match found:
        case SingleForce() | SpringDamper() if (found.sort == TRANSLATIONAL) == (kind == "F"):
            i, j = mechanism.ends(found)
            if isinstance(found, SingleForce):
                size = times(translation.translated(found.function), unit)
            else:
                size = _of_spring(found, i.reference, j.reference)
            if kind == "F" and not (isinstance(found, SingleForce) and found.action_only):
                yield _Part(size, j.reference, i.reference, measured("dm", i.reference, j.reference, ""))
            else:
                yield _Part(size, j.reference, mechanism.tip(j))
        case VectorForce():
            laws = found.force if kind == "F" else found.torque
            frame = mechanism.place(found.axes, found, "RM") if found.axes else None
            for axis, law in zip("xyz", laws, strict=True):
                if law is not None:
                    yield _on_axis(times(translation.translated(law), unit), axis, frame, mechanism)
        case Bushing() if kind == "F":
            i, j = mechanism.ends(found)
            for k, axis in enumerate("xyz"):
                yield _on_axis(_of_bushing(found, k, i.reference, j.reference, translation), axis, j, mechanism)
        case Bushing():
            raise function.fault(f"found the torque of {found.label}, expected it in a REQUEST only")


def _on_axis(size: ast.expr, axis: str, frame: Place | None, mechanism: Mechanism) -> _Part:
    if frame is None:
        return _Part(size, axis=axis)
    return _Part(size, frame.reference, mechanism.tip(frame, axis))


def _of_spring(spring: SpringDamper, i: str, j: str) -> ast.expr:
    """Return the force that pushes the markers apart, or the torque about z of J."""
    if spring.sort == TRANSLATIONAL:
        displacement, rate = measured("dm", i, j, ""), measured("vr", i, j, "")
    else:
        displacement, rate = measured("az", i, j, ""), measured("wz", i, j, j)
    return total([
        number(spring.preload), times(difference(displacement, number(spring.length)), -spring.stiffness),
        times(rate, -spring.damping),
    ])  # fmt: skip


def _of_bushing(bushing: Bushing, k: int, i: str, j: str, translation: Translation) -> ast.expr:
    """Return a component of the force on marker I in the axes of J."""
    axis = "xyz"[k]
    return total([
        number(bushing.preload[k]),
        times(measured(f"d{axis}", i, j, j), -bushing.stiffness[k][k]),
        times(translation.relative(axis, i, j, j, j, 1.0), -bushing.damping[k][k]),
    ])  # fmt: skip
