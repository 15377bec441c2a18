"""Equations stated by a joint or force class, as checked expressions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from ...elements.element import Force, Joint
from ...errors import InputError
from ..kind import Kind
from .symbols import Symbols, symbols_of


@dataclass(frozen=True)
class ElementEquations:
    """Expressions from which everything else is derived.

    - `point`: reference point of the reaction's torque.
    - `event_functions`: event functions of breakpoints in the state.
    - `position`, `velocity`: equations of a joint.
    - `powers`: efforts and rates of a force.
    - `rates`: rates of a force's own states.
    - `condensed`: efforts and rates of a force that may be very stiff, along its own directions.
    """

    point: tuple[sp.Expr, ...]
    event_functions: tuple[sp.Expr, ...]
    position: tuple[sp.Expr, ...] = ()
    velocity: tuple[sp.Expr, ...] = ()
    powers: tuple[tuple[sp.Expr, sp.Expr], ...] = ()
    potential: sp.Expr = sp.S.Zero
    limits: tuple[sp.Expr, ...] = ()
    measured: tuple[sp.Expr, ...] = ()
    rates: tuple[sp.Expr, ...] = ()
    condensed: tuple[tuple[sp.Expr, sp.Expr], ...] = ()


def equations_of_joint(kind: Kind, symbols: Symbols) -> ElementEquations:
    """Return the equations of a joint. Raises InputError if they are invalid; names the class."""
    asked = _Asked(kind.element, symbols)
    position, velocity = asked.column("position"), asked.column("velocity")
    names = kind.element.equations  # type: ignore[attr-defined]
    if names and len(position) + len(velocity) != len(names):
        raise InputError(
            f"{kind.element.__name__}: found {len(position) + len(velocity)} expressions from position and velocity, "
            f"expected {len(names)}, one for each of its equations ({', '.join(names)})"
        )
    return asked.known(ElementEquations(asked.column("point"), asked.event_functions(), position, velocity))


def measured_of_joint(kind: Kind, symbols: Symbols, lam: Iterable[sp.Expr]) -> tuple[sp.Expr, ...]:
    """Return the reported values of a joint, given its multipliers: coordinates with their rates, or an effort.

    Raises InputError if they are invalid; names the class.
    """
    asked, e = _Asked(kind.element, symbols), symbols.element
    e.counts, e.__dict__["lam"] = False, list(lam)
    measured = asked.measured()
    return asked.known(ElementEquations((), (), measured=measured)).measured


def equations_of_force(kind: Kind, symbols: Symbols) -> ElementEquations:
    """Return the law of a force. Raises InputError if it is invalid; names the class."""
    asked = _Asked(kind.element, symbols)
    powers, condensed = asked.pairs(), asked.condensed()
    (potential,) = asked.column("potential")
    limits, measured = asked.column("limits"), asked.measured()
    rates = asked.column("rates")
    if len(rates) != kind.n_own:
        raise InputError(
            f"{kind.element.__name__}.rates: found {len(rates)} expressions, expected {kind.n_own}, one for each of its own_states"
        )
    return asked.known(
        ElementEquations(
            asked.column("point"), asked.event_functions(), powers=powers, potential=potential, limits=limits,
            measured=measured, rates=rates, condensed=condensed,
        )
    )  # fmt: skip


def multipliers(name: str, count: int) -> sp.Matrix:
    """Return a column of symbols for the multipliers of one element's equations."""
    return sp.Matrix([sp.Symbol(f"{name}{k}", real=True) for k in range(count)])


def text_of(kind: Kind) -> str:
    """Return a text that determines all derived terms of a kind: its equations and the expressions of their symbols."""
    symbols = symbols_of(kind)
    equations = (equations_of_joint if issubclass(kind.element, Joint) else equations_of_force)(kind, symbols)
    if issubclass(kind.element, Joint):
        lam = multipliers("lam", len(equations.position) + len(equations.velocity))
        equations = replace(equations, measured=measured_of_joint(kind, symbols, lam))
    e, laws = symbols.element, [(law.argument, *law.of) for law in symbols.laws]
    parts = (*vars(equations).values(), list(e.meanings.items()), symbols.numbers, laws, e.angles, symbols.joint_lam)
    return repr((sp.srepr(parts), getattr(kind.element, "turns", False)))


class _Asked:
    """Caller of a class's equations; errors are reported in one sentence that names the class."""

    def __init__(self, element: type[Any], symbols: Symbols) -> None:
        self.element, self.symbols, self.e = element, symbols, symbols.element

    def column(self, name: str) -> tuple[sp.Expr, ...]:
        """Return a list of expressions, or a single one as a list."""
        found = self._called(name)
        return tuple(
            self._read(name, part) for part in (found if isinstance(found, Iterable | sp.MatrixBase) else (found,))
        )

    def pairs(self) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
        """Return pairs of an effort and a rate from `powers`, or from `efforts` on coordinates."""
        owners = (owner for owner in self.element.__mro__ if owner not in (Force, Joint))
        name = "powers" if any("powers" in vars(owner) for owner in owners) else "efforts"
        try:
            pairs = [(effort, works_on) for effort, works_on in self._called(name)]
        except (TypeError, ValueError):
            raise InputError(
                f"{self.element.__name__}.{name}: expected a list of pairs, an effort and what it works on"
            ) from None
        found = [(self._read(name, effort), self._read(name, works_on)) for effort, works_on in pairs]
        return tuple((effort, x if name == "powers" else self.e.rate(x)) for effort, x in found)

    def condensed(self) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
        """Return pairs of an effort and a rate from `condensed_powers`; none for forces that depend on reactions."""
        if self.symbols.joint_lam:
            return ()
        name = "condensed_powers"
        return tuple((self._read(name, effort), self._read(name, rate)) for effort, rate in self._called(name))

    def measured(self) -> tuple[sp.Expr, ...]:
        """Return the expressions of the channels of the class."""
        found, channels = self.column("measured"), self.element.channels
        if len(found) != len(channels):
            raise InputError(
                f"{self.element.__name__}.measured: found {len(found)} expressions, expected one for each of its channels "
                f"({', '.join(channels) or 'none'})"
            )
        return found

    def event_functions(self) -> tuple[sp.Expr, ...]:
        """Return the breakpoints of formulas, and those stated by the class, or else those of its equations."""
        named = issubclass(self.element, Force) and self.element.event_functions is not Force.event_functions
        own = self.column("event_functions") if named else [x for x in self.e.breakpoints if self.symbols.in_state(x)]
        return (*self.symbols.event_functions, *(x for x in own if named or x not in self.symbols.event_functions))

    def known(self, equations: ElementEquations) -> ElementEquations:
        """Return the equations after a check that all symbols are defined."""
        parts = sp.flatten(vars(equations).values())
        meant = {*self.symbols.known(), *getattr(self.e, "lam", ())}
        for symbol in sorted({symbol for x in parts for symbol in self.e.derivatives.variables(x)} - meant, key=str):
            raise InputError(
                f"{self.element.__name__}: found the symbol {symbol} in its equations, expected fields, markers and time of e"
            )
        return equations

    def _called(self, name: str) -> Any:
        try:
            return getattr(self.element, name)(self.e)
        except InputError as error:
            raise InputError(f"{self.element.__name__}.{name}: {error}") from None
        except Exception as error:
            raise InputError(f"{self.element.__name__}.{name}: {type(error).__name__}: {error}") from error

    def _read(self, name: str, x: sp.Expr) -> sp.Expr:
        try:
            return self.e.read(x)
        except (InputError, sp.SympifyError) as error:
            raise InputError(f"{self.element.__name__}.{name}: {error}") from None
