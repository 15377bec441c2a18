"""Generation of kernel sources from derived terms: common subexpressions, then one loop over elements."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp
from sympy.printing.pycode import PythonCodePrinter

from ...reading.formula.functions import FUNCTIONS
from ..machine import compiler
from ..terms import KERNEL_ARGUMENTS, TERM_SETS
from .continuous_angle import ContinuousAngle, counter
from .derive import Derived
from .nonsmooth import NonsmoothBase, Step
from .relative_rotation import RotationVector
from .shared_parts import written
from .spline import CommonNormal, CommonNormalSlope, PythonCall, Spline


def _natives(base: type[NonsmoothBase]) -> set[str]:
    """Return the names of the native nonsmooth functions."""
    return {each.native for each in base.__subclasses__() if each.native}.union(*map(_natives, base.__subclasses__()))


def _imported(module: str, names: Iterable[str]) -> str:
    return f"from {module} import {', '.join(sorted(names))}\n"


NATIVE = "stiffmbs.compile.machine.native"
HEADER = (
    _imported(f"{NATIVE}.nonsmooth", ["continuous_angle", *_natives(NonsmoothBase)])
    + _imported(f"{NATIVE}.spline", ["spline"])
    + _imported(f"{NATIVE}.rotation_vector", ["rotation_vector"])
    + _imported("math", ["copysign", *(name for name, function in FUNCTIONS.items() if function.in_c)])
    + "\n\n"
)
"""Imports of every kernel."""
PYTHON = "from stiffmbs.compile.machine.native.python_call import python_call\n"
"""Import of kernels that call Python functions."""
GEOMETRY = f"from {compiler.GEOMETRY}.common_normal import common_normal, common_normal_slope\n"
"""Import of kernels for contacts between solids."""


class _Printer(PythonCodePrinter):
    """Python printer of functions, with plain names."""

    def _print_NumberSymbol(self, expr: sp.NumberSymbol) -> str:
        """Return the value of a constant such as pi."""
        return repr(float(expr))

    _print_Pi = _print_Exp1 = _print_EulerGamma = _print_GoldenRatio = _print_Catalan = _print_NumberSymbol

    def _print_NonsmoothBase(self, expr: NonsmoothBase) -> str:
        arguments = [f"{argument}.0" if argument.is_Integer else self._print(argument) for argument in expr.args]
        if isinstance(expr, Step):
            arguments[-1] = str(expr.args[-1])
        return f"{expr.native}({', '.join(arguments)})"

    def _print_ContinuousAngle(self, expr: ContinuousAngle) -> str:
        return f"continuous_angle({', '.join(self._print(argument) for argument in expr.args)})"

    def _print_Spline(self, expr: Spline) -> str:
        x, table, order = expr.args
        return f"spline(number, {self._print(table)}, {self._print(x)}, {int(order)})"

    def _print_PythonCall(self, expr: PythonCall) -> str:
        address, count, output, by, *arguments = expr.args
        return f"python_call({address}, {int(count)}, {int(output)}, {int(by)}, {self._numbers(arguments)})"

    def _print_CommonNormal(self, expr: CommonNormal) -> str:
        component, *pose = expr.args
        return f"common_normal({int(component)}, {self._numbers(pose)})"

    def _print_CommonNormalSlope(self, expr: CommonNormalSlope) -> str:
        component, by, *pose = expr.args
        return f"common_normal_slope({int(component)}, {int(by)}, {self._numbers(pose)})"

    def _numbers(self, arguments: Iterable[sp.Expr]) -> str:
        return ", ".join(f"{x}.0" if x.is_Integer else self._print(x) for x in arguments)

    def _print_RotationVector(self, expr: RotationVector) -> str:
        h, order = expr.args
        return f"rotation_vector({self._print(h)}, {int(order)})"


def kernel_source(term_set: str, derived: Derived, name: str) -> str:
    """Return the source of one kernel, in the language of `stiffmbs.compile.machine.translate`.

    Shared orientation values of the bodies are read, not computed per element. Entry `entry` of term k of element e is
    stored in ``value[place[1 + k] + entries_k*e + entry]``.
    """
    e, terms, equations = derived.symbols.element, derived.terms, derived.n_equations
    turned = {function: symbol for frame in e.frames for function, symbol in frame.turned.items()}
    outputs = [
        (k, len(terms.get(term, ())), n, sp.sympify(entry.expression))
        for k, term in enumerate(TERM_SETS[term_set])
        for n, entry in enumerate(terms.get(term, ()))
    ]
    printer = _Printer({"fully_qualified_modules": False, "precision": 17})
    code = written([expression for *_, expression in outputs], e.derivatives, turned, printer)
    needed = code.symbols
    first_state = 2 * len(e.frames) + 1 + len(derived.symbols.joint_lam)
    first_counter = first_state + len(e.states)
    width = first_counter + len(e.angles)

    body = [f"own = index[{width}*e + {2 * len(e.frames)}]"]
    for slot, frame in enumerate(e.frames):
        for offset, state, symbols in (
            (2 * slot, "q", frame.q),
            (2 * slot, "turn", frame.turn),
            (2 * slot + 1, "u", frame.u),
            (2 * slot + 1, "a", frame.a),
        ):
            if needed & set(symbols):
                stride = f"{frame.turn_stride}*" if state == "turn" and frame.turn_stride > 1 else ""
                body.append(f"at = {stride}index[{width}*e + {offset}]")
                body += [f"{s.name} = {state}[at + {k}]" for k, s in enumerate(symbols) if s in needed]
    for k, symbol in enumerate(derived.symbols.numbers):
        if symbol in needed:
            value = f"own + int(number[own + {k}])" if symbol.is_integer else f"number[own + {k}]"
            body.append(f"{symbol.name} = {value}")
    for vector in ("lam", "mu"):
        body += [
            f"{vector}{k} = {vector}[row + {equations}*e + {k}]"
            for k in range(equations)
            if sp.Symbol(f"{vector}{k}", real=True) in needed
        ]
    for joint, lam in enumerate(derived.symbols.joint_lam):
        row = f"index[{width}*e + {2 * len(e.frames) + 1 + joint}]"
        body += [f"{symbol.name} = lam[{row} + {k}]" for k, symbol in enumerate(lam) if symbol in needed]
    body += [
        f"{symbol.name} = q[index[{width}*e + {first_state + k}]]"
        for k, symbol in enumerate(e.states)
        if symbol in needed
    ]
    body += [
        f"{counter(k).name} = q[index[{width}*e + {first_counter + k}]]"
        for k in range(len(e.angles))
        if counter(k) in needed
    ]
    body += [f"{name} = {part}" for name, part in code.assignments]
    entries_of = {k: entries for k, entries, *_ in outputs}
    body += [f"to{k} = first{k} + {entries}*e" for k, entries in entries_of.items()]
    body += [f"value[to{k} + {n}] = {result}" for (k, _, n, _), result in zip(outputs, code.results, strict=True)]
    before = ["row = place[0]", *(f"first{k} = place[{1 + k}]" for k in entries_of)]  # no pass moves them there
    lines = [f"def {name}({KERNEL_ARGUMENTS}):", *(f"    {line}" for line in before), "    for e in range(count):"]
    lines += [f"        {line}" for line in body]
    wanted = {PYTHON: "python_call(", GEOMETRY: "common_normal("}
    imports = [text for text, call in wanted.items() if any(call in line for line in body)]
    return "".join([*imports, HEADER]) + "\n".join(lines) + "\n"
