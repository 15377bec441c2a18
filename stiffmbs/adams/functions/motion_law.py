"""Motions as functions of time in SI units."""

from __future__ import annotations

import ast
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from ...elements.spatial.number_format import plain
from ...reading.files.quoted import quoted
from ...reading.formula.text import FormulaError, parse
from ..statements.constraints import TRANSLATIONAL, Motion
from ..statements.geometry import ROUNDING
from .function import Function
from .translate import Translation
from .trees import number, times, total

ORDERS = ("position", "velocity")


MOST_PARTS = 10_000
"""Largest number of syntax-tree nodes in the value of a VARIABLE after substitution."""
PATIENCE = 10.0
"""Time limit of symbolic integration, s."""
LARGEST_EXPONENT = 32
"""Largest exponent in an integrand: powers of sums are expanded."""
INTEGRALS = {"t", "pi", "sin", "cos", "exp", "sqrt", "log", "tan", "atan"}
"""Names in integrals that formulas can evaluate."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise `TimeoutError` after a time; no effect outside the main thread or without alarm signals."""
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def too_long(number: int, frame: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, too_long)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


class _InPlace(Translation):
    """Translator of one dataset's expressions that substitutes each VARIABLE by its expression."""

    def variable(self, ident: int, function: Function) -> ast.expr:
        """Return the expression of a VARIABLE; its name if it depends on itself."""
        variable = self.mechanism.dataset.variables.get(ident)
        if variable is None or ident in self.implicit_variables:
            return super().variable(ident, function)
        value = self.translated(variable.function)
        if sum(1 for _ in ast.walk(value)) > MOST_PARTS:
            raise function.fault(
                f"found VARVAL({ident}) with more than {MOST_PARTS} terms after substitution of variables, expected fewer"
            )
        return value


def _check_exponents(tree: ast.expr) -> None:
    for node in ast.walk(tree):
        match node:
            case ast.BinOp(_, ast.Pow(), ast.Constant(int() | float() as power)) if abs(power) > LARGEST_EXPONENT:
                raise ValueError(f"found the exponent {power}, expected one up to {LARGEST_EXPONENT}")


class _WithoutInstants(ast.NodeTransformer):
    """Replace the middle value of IF by the value that follows in time.

    The middle value holds at one instant only. As a motion it would have zero velocity at that instant.
    """

    def visit_Call(self, node: ast.Call) -> ast.Call:
        """Replace the middle value of an IF."""
        self.generic_visit(node)
        match node:
            case ast.Call(ast.Name("branch"), [x, below, _, above]):
                return ast.Call(node.func, [x, below, below if _falls(x) else above, above], [])
        return node


def _falls(condition: ast.expr) -> bool:
    """Return True if an expression decreases with time: ``0.5 - t``."""
    import sympy as sp

    t = sp.Symbol("t", real=True)
    try:
        slope = sp.diff(sp.sympify(ast.unparse(condition), locals={"t": t}), t)
    except (sp.SympifyError, TypeError, AttributeError, ValueError, ArithmeticError, RecursionError):
        return False
    return bool(slope.is_negative)


class Law:
    """Function of a motion.

    `sort`: rotational or translational.
    """

    def __init__(self, motion: Motion, translation: Translation, sort: str) -> None:
        self._motion, self._translation = motion, _InPlace(translation.mechanism)
        units = translation.units
        self._length = units.length if sort == TRANSLATIONAL else 1.0
        self._unit = self._length / units.time**motion.order
        start, velocity = motion.start
        self._start = None if start is None else start * self._length
        self._velocity = (velocity or 0.0) * self._length / units.time

    def over_time(self, initial: float) -> dict[str, str]:
        """Return the prescribed position or velocity of a drive by its field name.

        A velocity is prescribed directly if the motion starts at the initial pose. Otherwise it is integrated to a
        position, as is an acceleration: by a formula if there is one, or by states. `initial`: the displacement at the
        initial pose, m or rad.
        """
        order = self._motion.order
        if order == 0 or (order == 1 and (self._start is None or abs(self._start - initial) <= ROUNDING)):
            return {ORDERS[order]: self._formula()}
        start = initial if self._start is None else self._start
        integral = self._integrated()
        if integral is None:
            return {"position": self._state(start)}
        terms = [number(start)] if start else []
        if order == 2 and self._velocity:
            terms.append(times(ast.Name("t"), self._velocity))
        return {"position": ast.unparse(total([*terms, integral]))}

    def _state(self, start: float) -> str:
        """Add a state of the scene for each integral without a formula, and return the name of the displacement.

        Raises DatasetFault if the function measures positions, velocities or reactions.
        """
        function, dataset = self._motion.function, self._translation.mechanism.dataset
        joints = {joint.name for joint in (*dataset.joints.values(), *dataset.primitives.values())}
        for node in ast.walk(parse(self._formula())):
            if isinstance(node, ast.Attribute) or (isinstance(node, ast.Name) and node.id in joints):
                raise function.fault(
                    f"found '{ast.unparse(node)}' measured in '{quoted(function.text)}', expected a function of time"
                )
        displacement, velocity = (f"{self._motion.name}_{what}" for what in ("displacement", "velocity"))
        states = {displacement: {"rate": self._formula(), "start": plain(start)}}
        if self._motion.order == 2:
            states[velocity] = states[displacement] | {"start": plain(self._velocity)}
            states[displacement]["rate"] = velocity
        self._translation.mechanism.states |= states
        return displacement

    def _formula(self) -> str:
        try:
            formula = parse(self._translation.formula(self._motion.function, self._unit))
        except FormulaError as error:
            raise self._motion.function.fault(str(error)) from None
        return ast.unparse(_WithoutInstants().visit(formula))

    def _integrated(self) -> ast.expr | None:
        """Return the function integrated from 0 to t, once or twice; None if the integral is not a formula."""
        import sympy as sp

        t, s = sp.Symbol("t", real=True), sp.Symbol("s", real=True)
        formula = self._formula()
        try:
            _check_exponents(parse(formula))
            with time_limit(PATIENCE):
                integral = sp.sympify(formula, locals={"t": t})
                for _ in range(self._motion.order):
                    integral = sp.integrate(integral.subs(t, s), (s, 0, t))
                found = sp.simplify(integral)
            parsed = parse(str(found))
        except (sp.SympifyError, ValueError, TypeError, AttributeError, ArithmeticError, RecursionError, TimeoutError):
            return None
        names = {node.id for node in ast.walk(parsed) if isinstance(node, ast.Name)}
        return parsed if names <= INTEGRALS else None
