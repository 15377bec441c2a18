"""Translation of function expressions to formulas of a scene.

Measures are divided by the dataset's unit so that constants in the expression keep their meaning. The caller multiplies
the result by its unit.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from functools import cached_property

from ...reading.files.quoted import quoted
from ...reading.units.quantity import CONSTANTS
from ..scene.mechanism import Mechanism
from ..statements.declared import Numbered
from ..statements.systems import Differential
from .adams_functions import ADAMS_FUNCTIONS
from .expression import IF, OMITTED, parse
from .force_laws import LAWS, force_between, force_by_law
from .function import Function
from .inputs import PLANTS, evaluated_name, variable_of_plant
from .measures import ANGLES_OF_AXES, COMPONENTS, REACTIONS, angle, included_angle, on_ground
from .splines import CURVES, spline_value
from .states import depending_on_themselves, differential, value_of_system
from .trees import magnitude, measured, name_of, over, product, times

POSITIONS, ANGLES = ("DX", "DY", "DZ", "DM"), ("AX", "AY", "AZ")
VELOCITIES, ANGULAR_VELOCITIES = ("VX", "VY", "VZ", "VM", "VR"), ("WX", "WY", "WZ", "WM")
MAGNITUDES = ("DM", "VM", "VR", "WM")
"""Measures without axes."""
PLAIN = {
    **{name: name.lower() for name in (
        "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "ATAN2", "SINH", "COSH", "TANH", "EXP", "SQRT", "ABS", "MIN", "MAX",
        "STEP", "STEP5", "LOG",
    )},
    IF: "branch",
}  # fmt: skip
"""Functions with an equivalent in scene formulas."""
COUPLED = (
    "MOTION", "GCON", "COUPLER", "GEAR", "PTCV", "CVCV", "CONTACT", "BEAM", "FIELD",
)  # fmt: skip
"""Force functions that only requests may use."""
NAMES = {"DTOR": math.pi / 180, "RTOD": 180 / math.pi}


class Translation:
    """Translator of the expressions of one dataset.

    `substituted`: labels of the forces whose laws, and of the DIFFs whose rates, are being substituted.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.units = mechanism.dataset.units
        self.substituted: list[str] = []

    @cached_property
    def implicit_variables(self) -> frozenset[int]:
        """VARIABLEs that depend on themselves: algebraic states of the scene."""
        return depending_on_themselves(self.mechanism.dataset)

    def force_unit(self, component: str) -> float:
        """Return the unit of a component of a force, or of a torque ('T...'), N or N m."""
        return self.units.of(force=1, length=1 if component[0] == "T" else 0)

    def formula(self, function: Function, unit: float = 1.0) -> str:
        """Return an expression as a formula, times a unit.

        Raises DatasetFault if it uses functions that scene formulas lack.
        """
        return ast.unparse(times(self.translated(function), unit))

    def law(self, text: str, user: Numbered, *, arm: int = 0) -> str:
        """Return a force, or with an arm of 1 a torque, that is written as an Adams function, as a formula."""
        return self.formula(Function(text, parse(text), user.line, user.label), self.units.of(force=1, length=arm))

    def translated(self, function: Function) -> ast.expr:
        """Return an expression as the syntax tree of a formula."""

        def translate(node: ast.expr) -> ast.expr:
            match node:
                case ast.BinOp(left, op, right):
                    return ast.BinOp(translate(left), op, translate(right))
                case ast.UnaryOp(op, operand):
                    return ast.UnaryOp(op, translate(operand))
                case ast.Name(name):
                    return self.name(name, function)
                case ast.Call(ast.Name("VARVAL"), arguments):
                    return self.variable(function.identifier(arguments, 0), function)
                case ast.Call(ast.Name(name), arguments):
                    return self.call(name, arguments, function, translate)
            return node

        return translate(function.tree)

    def name(self, name: str, function: Function) -> ast.expr:
        """Return a constant, or time."""
        if name == "TIME":
            return over(ast.Name("t"), self.units.time)
        if name == "PI":
            return ast.Constant(CONSTANTS["pi"].value)
        if name in NAMES:
            return ast.Constant(NAMES[name])
        if name == OMITTED:
            raise function.fault(f"found nothing before a comma of '{quoted(function.text)}', expected a value")
        raise function.fault(
            f"found '{name}' in '{quoted(function.text)}', expected TIME, PI, DTOR, RTOD or a function"
        )

    def variable(self, ident: int, function: Function) -> ast.expr:
        """Return the name of a VARIABLE and add it to the scene."""
        variable = self.mechanism.dataset.variables.get(ident)
        if variable is None:
            raise function.fault(f"found VARVAL({ident}), expected the number of a VARIABLE")
        if ident in self.implicit_variables:
            return name_of(variable.state)
        if variable.name not in self.mechanism.variables and variable.name not in self.mechanism.inputs:
            self.mechanism.variables[variable.name] = self.formula(variable.function)
        return name_of(variable.name)

    def call(
        self, name: str, arguments: list[ast.expr], function: Function, translate: Callable[[ast.expr], ast.expr]
    ) -> ast.expr:
        """Return a measure, or a function of numbers."""
        if name in (*POSITIONS, *ANGLES, *VELOCITIES, *ANGULAR_VELOCITIES):
            return self.measure(name, arguments, function)
        if name in PLAIN:
            return ast.Call(ast.Name(PLAIN[name]), [translate(argument) for argument in arguments], [])
        if name in ADAMS_FUNCTIONS:
            try:
                return ADAMS_FUNCTIONS[name](*map(translate, arguments))
            except TypeError:
                raise function.fault(
                    f"found {len(arguments)} arguments of {name} in '{quoted(function.text)}', expected another number"
                ) from None
        if name in (*CURVES, "INTERP"):
            return spline_value(name, arguments, function, translate, self.mechanism)
        if name == "SENVAL":
            return name_of(evaluated_name(self.mechanism, function.identifier(arguments, 0), function))
        if name in PLANTS:
            plant, at = function.identifiers(arguments, 2)
            return self.variable(variable_of_plant(self.mechanism.dataset, name, plant, at, function), function)
        if name == "ARYVAL":
            return self.array_value(arguments, function)
        if name == "DIF":
            return name_of(differential(self.mechanism.dataset, function.identifier(arguments, 0), function).name)
        if name == "DIF1":
            equation = differential(self.mechanism.dataset, function.identifier(arguments, 0), function)
            return name_of(equation.rate) if equation.implicit else self.rate(equation, function, translate)
        if name in ANGLES_OF_AXES:
            return self._angle(name, arguments, function)
        if name in (*REACTIONS, *LAWS):
            return force_by_law(name, arguments, function, self)
        if name in COMPONENTS:
            return force_between(name, arguments, function, self)
        if name in COUPLED:
            raise function.fault(
                f"found {name} in '{quoted(function.text)}', a force that depends on others at the same time, expected it in a "
                f"REQUEST, or one of {', '.join((*REACTIONS, *LAWS, *COMPONENTS))}"
            )
        if name == "INCANG":
            ends = [self.reference(function.identifier(arguments, k), function) for k in range(3)]
            return included_angle(*ends)
        raise function.fault(f"found the function {name} in '{quoted(function.text)}', expected a supported function")

    def rate(self, of: Differential, function: Function, translate: Callable[[ast.expr], ast.expr]) -> ast.expr:
        """Return the expression of the rate of an explicit DIFF. Raises DatasetFault if it contains that rate."""
        if of.label in self.substituted:
            raise function.fault(
                f"found DIF1({of.ident}) in the rate of {of.label}, expected IMPLICIT for an equation of its rate"
            )
        self.substituted.append(of.label)
        try:
            return translate(of.function.tree)
        finally:
            self.substituted.pop()

    def measure(self, name: str, arguments: list[ast.expr], function: Function) -> ast.expr:
        """Return a displacement, velocity or angle between markers.

        The velocity of i relative to j in the frame of a third marker's part is the velocity in ground minus w x d: w
        is the angular velocity of that part and d the displacement from j to i.
        """
        i, j, axes, seen_from = self._markers(name, arguments, function)
        if name in (*ANGLES, *ANGULAR_VELOCITIES):
            unit = 1.0 if name in ANGLES else 1 / self.units.time
        else:
            unit = self.units.of(length=1, time=-1 if name in VELOCITIES else 0)
        if name == "VM" and seen_from:
            return magnitude(self.relative(axis, i, j, "", seen_from, unit) for axis in "xyz")
        if name in ("VX", "VY", "VZ") and seen_from:
            return self.relative(name[1].lower(), i, j, axes, seen_from, unit)
        return over(measured(name.lower(), i, j, axes), unit)

    def relative(self, axis: str, i: str, j: str, axes: str, frame: str, unit: float) -> ast.expr:
        """Return a component of the velocity of i relative to j in the frame of a marker's part."""
        u, v = {"x": ("y", "z"), "y": ("z", "x"), "z": ("x", "y")}[axis]
        velocity = measured(f"v{axis}", i, j, axes)
        turned = [
            product(measured(f"w{a}", frame, "", axes), measured(f"d{b}", i, j, axes)) for a, b in ((u, v), (v, u))
        ]
        return over(ast.BinOp(ast.BinOp(velocity, ast.Sub(), turned[0]), ast.Add(), turned[1]), unit)

    def _markers(self, name: str, arguments: list[ast.expr], function: Function) -> tuple[str, str, str, str]:
        """Return the references of the markers i, j, axes and reference frame; '' means ground."""
        idents = function.identifiers(arguments)
        most = {"DM": 2, "AX": 2, "AY": 2, "AZ": 2, "VM": 3, "VR": 3, "WM": 3, "VX": 4, "VY": 4, "VZ": 4}.get(name, 3)
        if not 1 <= len(idents) <= most or not idents[0]:
            raise function.fault(
                f"found {len(idents)} markers of {name} in '{quoted(function.text)}', expected 1 to {most}"
            )
        found = [self.reference(ident, function) if ident else "" for ident in idents]
        i, j, *others = [*found, "", "", ""][:4]
        axes, seen_from = ("", others[0]) if name in MAGNITUDES else (others[0], others[1])
        return i, j, axes, "" if name in ("VR", "WM", *POSITIONS) or seen_from.startswith("ground") else seen_from

    def reference(self, ident: int, function: Function) -> str:
        """Return the scene reference of a marker."""
        marker = self.mechanism.dataset.markers.get(ident)
        if marker is None:
            raise function.fault(
                f"found the marker {ident} in '{quoted(function.text)}', expected the number of a MARKER"
            )
        if marker.floating:
            raise function.fault(
                f"found the floating marker {ident} in '{quoted(function.text)}', expected a fixed one"
            )
        return self.mechanism.placed(marker).reference

    def _angle(self, name: str, arguments: list[ast.expr], function: Function) -> ast.expr:
        idents = function.identifiers(arguments)
        if not 1 <= len(idents) <= 2 or not idents[0]:
            raise function.fault(f"found {len(idents)} markers of {name}, expected 1 or 2")
        places = [self.mechanism.place(ident, function) if ident else on_ground() for ident in (*idents, 0)[:2]]
        return angle(name, self.mechanism, *places)

    def array_value(self, arguments: list[ast.expr], function: Function) -> ast.expr:
        """Return a number of an ARRAY."""
        ident, at = function.identifiers(arguments, 2)
        of_system = value_of_system(self.mechanism.dataset, ident, at, function)
        if of_system is not None:
            return of_system
        array = self.mechanism.dataset.arrays.get(ident)
        if array is None or not 1 <= at <= len(array.numbers):
            raise function.fault(
                f"found ARYVAL({ident}, {at}), expected an ARRAY and the position of one of its numbers"
            )
        return ast.Constant(array.numbers[at - 1])
