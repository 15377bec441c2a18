"""Translation of request expressions, which may also contain accelerations, angles and element forces."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Final

from ..scene.contacts import swapped
from ..scene.forces import TORQUE
from ..statements.constraints import GeneralConstraint
from ..statements.contact import Contact
from ..statements.curves import CurveOnCurve, PointOnCurve
from ..statements.declared import Numbered
from ..statements.elastic import Elastic
from ..statements.forces import SingleForce, VectorForce
from .acting import acting_between, element_of, rod
from .function import Function
from .measures import COMPONENTS, component_of
from .translate import Translation
from .trees import call, components, cross, difference, magnitude, measured, name_of, number, over, times, total

ACCELERATIONS, ANGULAR_ACCELERATIONS = ("ACCX", "ACCY", "ACCZ", "ACCM"), ("WDTX", "WDTY", "WDTZ", "WDTM")
ANGLES = ("PSI", "THETA", "PHI")
ELEMENTS = {
    **{name: name for name in (
        "JOINT", "JPRIM", "GCON", "MOTION", "SFORCE", "VFORCE", "VTORQUE", "GFORCE", "BEAM", "FIELD", "COUPLER", "GEAR", "PTCV", "CVCV",
        "CONTACT",
    )},
    "VTORQ": "VTORQUE", "SPDP": "SPRINGDAMPER", "BUSH": "BUSHING",
}  # fmt: skip
"""Statements of the force functions."""
EULER_PARAMETERS: Final = 27
"""First argument of ORIENT for a quaternion, scalar first."""
ROUNDING_FUNCTIONS = {
    "MOD": "mod",
    "INT": "trunc",
    "AINT": "trunc",
    "ANINT": "round",
    "NINT": "round",
    "CEIL": "ceil",
    "FLOOR": "floor",
}


class OutputTranslation(Translation):
    """Translator of the expressions of requests and variables."""

    def call(
        self, name: str, arguments: list[ast.expr], function: Function, translate: Callable[[ast.expr], ast.expr]
    ) -> ast.expr:
        """Return the expression of a request function."""
        if name in (*ACCELERATIONS, *ANGULAR_ACCELERATIONS, *ANGLES):
            return self._measure(name, arguments, function)
        if name == "ORIENT":
            return self._orientation(arguments, function)
        if name in ELEMENTS:
            return self._of_element(name, arguments, function)
        if name in COMPONENTS:
            i, j, axes = (*function.identifiers(arguments), 0, 0)[:3]
            return over(self.between(name, i, j, axes, function), self.force_unit(name))
        if name in ROUNDING_FUNCTIONS:
            return call(ROUNDING_FUNCTIONS[name], *map(translate, arguments))
        return super().call(name, arguments, function, translate)

    def _measure(self, name: str, arguments: list[ast.expr], function: Function) -> ast.expr:
        found = [self.reference(ident, function) if ident else "" for ident in function.identifiers(arguments)]
        i, j, *others = [*found, "", "", ""][:4]
        if name in ANGLES:
            return measured(name.lower(), i, j, others[0])
        axes, frame = ("", others[0]) if name.endswith("M") else others
        linear = name in ACCELERATIONS
        unit = self.units.of(length=1 if linear else 0, time=-2)
        if not frame or frame.startswith("ground"):
            return over(measured(name.lower(), i, j, axes), unit)
        relative = _acceleration_in if linear else _angular_acceleration_in
        vector = relative(i, j, axes, frame)
        if name.endswith("M"):
            return over(magnitude(vector), unit)
        return over(vector["XYZ".index(name[-1])], unit)

    def _orientation(self, arguments: list[ast.expr], function: Function) -> ast.expr:
        sort, component, i, j = (
            *function.identifiers(arguments), 0, 0, 0, 0,
        )[:4]  # fmt: skip
        if sort != EULER_PARAMETERS or not 1 <= component <= 4 or not i:
            raise function.fault(
                f"found ORIENT({sort}, {component}, ...), expected Euler parameters, ORIENT(27, 1 to 4, i, j)"
            )
        other = self.reference(j, function) if j else ""
        return measured(f"q{component - 1}", self.reference(i, function), other, "")

    def _of_element(self, name: str, arguments: list[ast.expr], function: Function) -> ast.expr:
        """Translate JOINT(id, jflag, comp, rm) and similar functions."""
        ident, on_j, component, axes = function.identifiers(arguments, 4)
        found = element_of(name, ELEMENTS[name], ident, function, self.mechanism)
        if found is None:
            return number(0.0)
        which = component_of(name, component, function)
        if on_j and isinstance(found, GeneralConstraint) and rod(found) is None:
            raise function.fault(
                f"found the force of {found.label} on its marker J, expected the force on I: it has no marker J"
            )
        if on_j and isinstance(found, SingleForce) and found.action_only:
            return number(0.0)
        if isinstance(found, Contact):
            if which[0] == "T":
                raise function.fault(f"found the torque of {found.label}, expected a component of its force")
            on_j = bool(on_j) != swapped(found, self.mechanism)
        return over(self._component(which, [(found, bool(on_j))], axes, function), self.force_unit(which))

    def between(self, component: str, i: int, j: int, axes: int, function: Function) -> ast.expr:
        """Return the total force on marker i of the elements between it and marker j, in SI units."""
        acting = acting_between(i, j, function, self.mechanism)
        for found, on_j in acting:
            if on_j and isinstance(found, GeneralConstraint) and rod(found) is None:
                raise function.fault(
                    f"found the force of {found.label} on a marker other than its I, expected the force on I"
                )
        return self._component(component, acting, axes, function)

    def _component(
        self, component: str, acting: list[tuple[Numbered, bool]], axes: int, function: Function
    ) -> ast.expr:
        axes_name = self.reference(axes, function) if axes else ""
        parts = [(found, element, on_j) for found, on_j in acting for element in self._elements(found, component)]
        if component[1] == "M" and len(parts) > 1:
            return magnitude(self._component(component[0] + axis, acting, axes, function) for axis in "XYZ")
        terms = [self._term(component, found, element, on_j, axes_name) for found, element, on_j in parts]
        return total(terms) if terms else number(0.0)

    @staticmethod
    def _term(component: str, found: Numbered, element: str, on_j: bool, axes_name: str) -> ast.expr:
        """Return the force of one element on marker I or J; a floating marker coincides with I."""
        floats = isinstance(found, VectorForce | PointOnCurve | CurveOnCurve) and on_j
        owner = name_of(element + (".j" if on_j and not floats else ""))
        value = call(component.lower(), owner, *([name_of(axes_name)] if axes_name else []))
        return times(value, -1.0) if floats and component[1] != "M" else value

    @staticmethod
    def _elements(found: Numbered, component: str) -> list[str]:
        """Return the scene elements of a statement that have the component."""
        if isinstance(found, VectorForce):
            both = any(found.force) and any(found.torque)
            return (
                [found.name, *([found.name + TORQUE] if both else [])]
                if component[0] == "T" or any(found.force)
                else []
            )
        if isinstance(found, Elastic) and not found.has_potential and component[0] == "T":
            return [found.name, found.name + TORQUE]
        return [found.name]


def _acceleration_in(i: str, j: str, axes: str, frame: str) -> list[ast.expr]:
    """Return the second derivative of the displacement of i from j in a marker's frame: a - w' x d - 2 w x v + w x (w x d)."""
    w, d = components("w", frame, "", axes), components("d", i, j, axes)
    turning = cross(components("wdt", frame, "", axes), d)
    coriolis = cross(w, components("v", i, j, axes))
    terms = zip(components("acc", i, j, axes), turning, coriolis, cross(w, cross(w, d)), strict=True)
    return [total([difference(difference(a, b), times(c, 2.0)), e]) for a, b, c, e in terms]


def _angular_acceleration_in(i: str, j: str, axes: str, frame: str) -> list[ast.expr]:
    """Return the derivative of the angular velocity of i relative to j in a marker's frame."""
    turning = cross(components("w", frame, "", axes), components("w", i, j, axes))
    return [difference(a, b) for a, b in zip(components("wdt", i, j, axes), turning, strict=True)]
