"""Export of formulas as Adams/Solver function expressions."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping

from ...elements.requests.output import Output, Term, placeholder
from ...reading.files.quoted import quoted
from ...reading.formula.formula import Formula
from ...reading.formula.nodes import is_measure, is_reaction, joint_of, measured_markers
from ...reading.formula.text import UNIT
from ...reading.marker import GROUND, MarkerReference
from ...reading.table import Table
from ..functions.measures import COMPONENTS
from ..functions.splines import end_slopes, is_clamped
from ..functions.translate import PLAIN
from .numbering import Numbering, Refusal, number

SAME = {name for name, of_scene in PLAIN.items() if name == of_scene.upper()} - {"MIN", "MAX"}
"""Functions with the same name in Adams."""
OPERATORS: dict[type[ast.AST], tuple[str, int]] = {
    ast.Add: ("+", 1), ast.Sub: ("-", 1), ast.Mult: ("*", 2), ast.Div: ("/", 2), ast.Pow: ("**", 4),
}  # fmt: skip
"""Symbol and precedence of each operator."""
MEASURED = ("dx", "dy", "dz", "dm", "ax", "ay", "az", "vx", "vy", "vz", "vm", "vr", "wx", "wy", "wz", "wm")
REQUESTED = ("accx", "accy", "accz", "accm", "wdtx", "wdty", "wdtz", "wdtm", "psi", "theta", "phi")
"""Measures that only requests use."""
COORDINATES = {"x": "DX", "y": "DY", "z": "DZ", "vx": "VX", "vy": "VY", "vz": "VZ", "wx": "WX", "wy": "WY", "wz": "WZ"}


class Functions:
    """Exporter of the formulas of one scene.

    `names`: Adams functions of states and their outputs by name: ``DIF(3)``, ``VARVAL(1)``. `reactions`: reaction
    function and number of each joint by name.
    """

    def __init__(self, numbering: Numbering, names: dict[str, str], reactions: Mapping[str, tuple[str, int]]) -> None:
        self._numbering, self._names, self._reactions = numbering, names, reactions

    def text(self, law: Formula | Table | float, variable: str = "TIME") -> str:
        """Return the expression of a formula, a table of a variable, or a number.

        `variable`: expression of the law's own variable, such as the deflection of a spring. Raises Refusal if Adams
        has no equivalent function.
        """
        if isinstance(law, Table):
            return self._curve("of an element", law, variable)
        if not isinstance(law, Formula):
            return number(law)
        return self._with(dict.fromkeys(law.variables, f"({variable})"))._written(law.tree, law)

    def output(self, output: Output) -> str:
        """Return the expression of a request for measures, coordinates and states. Raises Refusal as `text`."""
        values = {name: quantity.value for name, quantity in output.quantities.items()}
        law = Formula(output.text, output.tree, (), values, velocities=True, tables=output.tables)
        terms = {placeholder(k): self._term(term) for k, term in enumerate(output.terms)}
        return self._with(terms)._written(output.tree, law)

    def _with(self, names: dict[str, str]) -> Functions:
        return Functions(self._numbering, {**self._names, **names}, self._reactions)

    def _term(self, term: Term) -> str:
        if term.element or term.function not in (*MEASURED, *REQUESTED):
            raise Refusal(f"found '{term}', expected a measure that Adams has")
        return f"{term.function.upper()}({','.join(str(self._numbering.marker(marker)) for marker in term.markers)})"

    def _written(self, node: ast.expr, law: Formula, tight: int = 0) -> str:
        match node:
            case ast.Constant(int() | float() as value):
                return number(value)
            case ast.UnaryOp(op, operand):
                inner = self._written(operand, law, 3)
                return f"({'-' if isinstance(op, ast.USub) else '+'}{inner})"
            case ast.BinOp(left, op, right):
                sign, binds = OPERATORS[type(op)]
                before = self._written(left, law, binds + (sign == "**"))
                after = self._written(right, law, binds + (sign in "-/"))
                return f"({before}{sign}{after})" if binds < tight else f"{before}{sign}{after}"
            case ast.Name(name):
                return self._name(name, law)
            case ast.Attribute(ast.Name(owner), name) if owner == UNIT:
                return number(law.values[f"{UNIT}.{name}"])
            case ast.Attribute(ast.Name(owner), name):
                return self._coordinate(owner, name, law)
            case ast.Call(ast.Name(name), arguments):
                return self._call(node, name, arguments, law)
        raise Refusal(f"found '{ast.unparse(node)}' in '{quoted(law.text)}', expected an expression that Adams has")

    def _name(self, name: str, law: Formula) -> str:
        if name == "t":
            return "TIME"
        if name in self._names:
            return self._names[name]
        if name not in law.values:
            raise Refusal(f"found '{name}' in '{quoted(law.text)}', expected an expression that Adams has")
        return f"({number(law.values[name])})" if law.values[name] < 0 else number(law.values[name])

    def _coordinate(self, body: str, name: str, law: Formula) -> str:
        if f"{body}.{name}" in self._names:
            return self._names[f"{body}.{name}"]
        if name not in COORDINATES:
            raise Refusal(
                f"found '{body}.{name}' in '{quoted(law.text)}', expected another coordinate, or angles between markers"
            )
        centre = self._numbering.center(body)
        origin = self._numbering.marker(MarkerReference(body=GROUND))
        return f"{COORDINATES[name]}({centre},{origin}{f',{centre}' if name.startswith('w') else ''})"

    def _call(self, node: ast.Call, name: str, arguments: list[ast.expr], law: Formula) -> str:
        if is_measure(node):
            if name not in MEASURED:
                raise Refusal(
                    f"found '{ast.unparse(node)}' in '{quoted(law.text)}', expected one of {', '.join(MEASURED)}"
                )
            markers = ",".join(str(self._numbering.marker(marker)) for marker in measured_markers(node))
            return f"{name.upper()}({markers})"
        if is_reaction(node):
            return self._reaction(node, name, law)
        if name in law.tables:
            table, argument = law.tables[name], arguments[0]
            clamped = is_clamped(argument, table.table[0][0], table.table[-1][0])
            return self._curve(name, table, self._written(argument, law), clamped)
        written = [self._written(argument, law) for argument in arguments]
        if name.upper() in SAME:
            return f"{name.upper()}({','.join(written)})"
        if name in WRITTEN:
            return WRITTEN[name](written)
        raise Refusal(f"found the function {name} in '{quoted(law.text)}', expected one that Adams has")

    def _reaction(self, node: ast.Call, name: str, law: Formula) -> str:
        joint = joint_of(node)
        if joint not in self._reactions:
            raise Refusal(
                f"found '{ast.unparse(node)}' in '{quoted(law.text)}', expected the reaction of a joint that Adams has"
            )
        function, ident = self._reactions[joint]
        return f"{function}({ident},0,{COMPONENTS.index(name.upper()) + 1},0)"

    def _curve(self, name: str, table: Table, argument: str, clamped: bool = False) -> str:
        """Return a table that continues with the slope of its end, where Adams would follow a parabola."""
        interpolation, ident = self._numbering.spline(name, table)
        if interpolation == "INTERP":  # its spline has LINEAR_EXTRAPOLATE
            return f"INTERP({argument},1,{ident})"
        if clamped:
            return f"{interpolation}({argument},0,{ident},0)"
        first, last = (f"({number(table.table[end][0])})" for end in (0, -1))
        inside = f"{interpolation}(MAX({first},MIN({last},{argument})),0,{ident},0)"
        low, high = (f"({number(slope)})" for slope in end_slopes(table))
        return f"({inside}+{low}*MIN({argument}-{first},0)+{high}*MAX({argument}-{last},0))"


def _nested(name: str) -> Callable[[list[str]], str]:
    def written(arguments: list[str]) -> str:
        """Nest a function of two arguments."""
        first, *rest = arguments
        return f"{name}({first},{written(rest)})" if rest else first

    return written


WRITTEN: dict[str, Callable[[list[str]], str]] = {
    "min": _nested("MIN"),
    "max": _nested("MAX"),
    "sign": lambda x: f"SIGN(1,{x[0]})",
    "branch": lambda x: f"IF({x[0]}:{','.join(x[1:])})",
    "asinh": lambda x: f"LOG(({x[0]})+SQRT(({x[0]})**2+1))",
}
"""Functions with another name or form in Adams."""
