"""Generation of kernel sources from derived terms: common subexpressions, then one loop over elements."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import sympy as sp
from sympy.core.exprtools import decompose_power
from sympy.core.sorting import default_sort_key
from sympy.printing.precedence import precedence
from sympy.printing.pycode import PythonCodePrinter

from ...reading.formula.functions import FUNCTIONS
from ..machine import compiler
from ..terms import KERNEL_ARGUMENTS, TERM_SETS
from .continuous_angle import ContinuousAngle, counter
from .derive import Derived
from .differentiate import Derivatives
from .nonsmooth import NonsmoothBase, Step
from .relative_rotation import RotationVector
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


def ordered_terms(x: sp.Add) -> list[sp.Expr] | None:
    """Return the terms of a sum in SymPy's order: by monomials, highest first.

    SymPy also compares coefficients, which is slow. They do not matter where monomials differ, as in all sums simplified by
    SymPy. The result is None if they do not, or for a number plus one other term.
    """
    if len(x.args) == 2 and any(term.is_number for term in x.args):
        return None
    monomials = [
        (term, dict(decompose_power(factor) for factor in sp.Mul.make_args(term) if not factor.is_number))
        for term in x.args
    ]
    bases = sorted({base for _, monomial in monomials for base in monomial}, key=default_sort_key)
    powers = {tuple(-monomial.get(base, 0) for base in bases): term for term, monomial in monomials}
    return [powers[power] for power in sorted(powers)] if len(powers) == len(x.args) else None


class _Printer(PythonCodePrinter):
    """Python printer with plain function names; small integer and half-integer powers are products and roots."""

    def _as_ordered_terms(self, expr: sp.Add, order: str | None = None) -> list[sp.Expr]:
        """Return the terms of a sum in SymPy's order, without its slow comparison of coefficients where possible."""
        return ordered_terms(expr) or super()._as_ordered_terms(expr, order)

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        base, power = expr.as_base_exp()
        twice = 2 * power
        if not (twice.is_Integer and 1 <= abs(int(twice)) <= 12):
            return super()._print_Pow(expr, rational=rational)
        whole, half = divmod(abs(int(twice)), 2)
        factor = self.parenthesize(base, precedence(expr))
        product = "*".join([factor] * whole + [f"sqrt({self._print(base)})"] * half)
        return f"({product})" if power > 0 else f"(1.0/({product}))"

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


def _shared(
    outputs: list[sp.Expr], derivatives: Derivatives, turned: Mapping[sp.Expr, sp.Symbol]
) -> tuple[list[tuple[sp.Symbol, sp.Expr]], list[sp.Expr]]:
    """Return common subexpressions in order of dependence, and the outputs in terms of them."""
    names: dict[sp.Symbol, sp.Expr] = {}
    meanings, symbols_in = derivatives.meanings, derivatives.symbols_in
    following = [symbol for output in outputs for symbol in _by_name(symbols_in(output))]
    while following:
        symbol = following.pop()
        if symbol in meanings and symbol not in names:
            names[symbol] = meanings[symbol].xreplace(turned)
            following += _by_name(symbols_in(names[symbol]))
    common, reduced = sp.cse([*outputs, *names.values()], symbols=sp.numbered_symbols("s_"), order="none")
    parts = {**dict(common), **dict(zip(names, reduced[len(outputs) :], strict=True))}
    ordered: dict[sp.Symbol, sp.Expr] = {}
    for symbol in parts:
        _append(symbol, parts, ordered)
    return list(ordered.items()), reduced[: len(outputs)]


def _by_name(symbols: Iterable[sp.Symbol]) -> list[sp.Symbol]:
    """Return symbols in a reproducible order, so that sums are reproducible."""
    return sorted(symbols, key=lambda symbol: symbol.name)


def _append(symbol: sp.Symbol, parts: Mapping[sp.Symbol, sp.Expr], ordered: dict[sp.Symbol, sp.Expr]) -> None:
    """Append a part after all parts that it uses."""
    pending = [symbol]
    while pending:
        last = pending[-1]
        missing = _by_name(part for part in parts[last].free_symbols if part in parts and part not in ordered)
        if last in ordered or not missing:
            ordered.setdefault(last, parts[last])
            pending.pop()
        else:
            pending += missing


def kernel_source(term_set: str, derived: Derived, name: str) -> str:
    """Return the source of one kernel, in the language of `stiffmbs.compile.machine.translate`.

    Shared orientation values of the bodies are read, not computed per element. Entry `entry` of term k of element e is
    stored in ``value[place[1 + k] + entries_k*e + entry]``.
    """
    e, terms, equations = derived.symbols.element, derived.terms, derived.n_equations
    turned = {function: symbol for frame in e.frames for function, symbol in frame.turned.items()}
    outputs = [
        (k, len(terms.get(term, ())), n, sp.sympify(entry.expression).xreplace(turned))
        for k, term in enumerate(TERM_SETS[term_set])
        for n, entry in enumerate(terms.get(term, ()))
    ]
    shared, results = _shared([expression for *_, expression in outputs], e.derivatives, turned)
    needed = {symbol for expression in [*results, *(part for _, part in shared)] for symbol in expression.free_symbols}
    printer = _Printer({"fully_qualified_modules": False, "precision": 17})
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
            f"{vector}{k} = {vector}[place[0] + {equations}*e + {k}]"
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
    body += [f"{symbol.name} = {printer.doprint(part)}" for symbol, part in shared]
    entries_of = {k: entries for k, entries, *_ in outputs}
    body += [f"to{k} = place[{1 + k}] + {entries}*e" for k, entries in entries_of.items()]
    body += [
        f"value[to{k} + {n}] = {printer.doprint(result)}" for (k, _, n, _), result in zip(outputs, results, strict=True)
    ]
    lines = [f"def {name}({KERNEL_ARGUMENTS}):", "    for e in range(count):", *(f"        {line}" for line in body)]
    wanted = {PYTHON: "python_call(", GEOMETRY: "common_normal("}
    imports = [text for text, call in wanted.items() if any(call in line for line in body)]
    return "".join([*imports, HEADER]) + "\n".join(lines) + "\n"
