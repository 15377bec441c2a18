"""What a class of joints or forces states: its equations as expressions, read and checked."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import sympy as sp

from ...describe.element import Force, Joint
from ...errors import InputError
from ..kind import Kind
from .symbols import Symbols, symbols_of


@dataclass(frozen=True)
class Stated:
    """The expressions that everything else is derived from.

    Attributes
    ----------
    point : tuple of Expr
        About which the reaction's torque is reported.
    event_functions : tuple of Expr
        What changes its sign at breakpoints in the state.
    position, velocity : tuples of Expr
        Of a joint.
    powers : tuple of (Expr, Expr)
        Of a force: efforts and rates.
    potential : Expr
    limits : tuple of Expr
    measured : tuple of Expr
    rates : tuple of Expr
        Of a force's own states.
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


def stated_by_joint(kind: Kind, symbols: Symbols) -> Stated:
    """The equations of a joint.

    Raises
    ------
    InputError
        When they cannot be used; names the class.
    """
    asked = _Asked(kind.element, symbols)
    position, velocity = asked.column("position"), asked.column("velocity")
    names = kind.element.equations  # type: ignore[attr-defined]
    if names and len(position) + len(velocity) != len(names):
        raise InputError(
            f"{kind.element.__name__}: found {len(position) + len(velocity)} expressions from position and velocity, "
            f"expected {len(names)}, one for each of its equations ({', '.join(names)})"
        )
    return asked.known(Stated(asked.column("point"), asked.event_functions(), position, velocity))


def stated_by_force(kind: Kind, symbols: Symbols) -> Stated:
    """The law of a force.

    Raises
    ------
    InputError
        When it cannot be used; names the class.
    """
    asked = _Asked(kind.element, symbols)
    powers = asked.pairs()
    (potential,) = asked.column("potential")
    limits, measured = asked.column("limits"), asked.column("measured")
    if len(measured) != len(kind.element.channels):  # type: ignore[attr-defined]
        raise InputError(
            f"{kind.element.__name__}.measured: found {len(measured)} expressions, expected one for each of its channels "
            f"({', '.join(kind.element.channels) or 'none'})"  # type: ignore[attr-defined]
        )
    rates = asked.column("rates")
    if len(rates) != kind.n_own:
        raise InputError(
            f"{kind.element.__name__}.rates: found {len(rates)} expressions, expected {kind.n_own}, one for each of its own_states"
        )
    point, events = asked.column("point"), asked.event_functions()
    found = Stated(point, events, powers=powers, potential=potential, limits=limits, measured=measured, rates=rates)
    return asked.known(found)


def text_of(kind: Kind) -> str:
    """All that is derived of a kind follows from this: its equations, and what the symbols in them stand for."""
    symbols = symbols_of(kind)
    stated = (stated_by_joint if issubclass(kind.element, Joint) else stated_by_force)(kind, symbols)
    meanings = [f"{symbol} = {sp.srepr(meaning)}" for symbol, meaning in symbols.element.meanings.items()]
    numbers = [str(symbol) for symbol in symbols.numbers]
    laws = [(sp.srepr(law.argument), law.of) for law in symbols.laws]
    angles = [sp.srepr(angle) for angle in symbols.element.angles]
    equations = [
        sp.srepr(sp.Tuple(*part) if isinstance(part, tuple) else part)
        for part in (
            stated.point,
            stated.event_functions,
            stated.position,
            stated.velocity,
            stated.potential,
            stated.limits,
            stated.measured,
            stated.rates,
        )
    ]
    powers = [(sp.srepr(effort), sp.srepr(rate)) for effort, rate in stated.powers]
    turns = getattr(kind.element, "turns", False)
    return repr((equations, powers, meanings, numbers, laws, angles, symbols.joint_lam, turns))


class _Asked:
    """A class that is asked for its equations; whatever goes wrong is told in one sentence that names it."""

    def __init__(self, element: type[Any], symbols: Symbols) -> None:
        self.element, self.symbols, self.e = element, symbols, symbols.element

    def column(self, name: str) -> tuple[sp.Expr, ...]:
        """A list of expressions, or one alone."""
        found = self._called(name)
        return tuple(
            self._read(name, part) for part in (found if isinstance(found, Iterable | sp.MatrixBase) else (found,))
        )

    def pairs(self) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
        """Pairs of an effort and a rate, from `powers`, or else from `efforts` on coordinates."""
        name = "powers" if "powers" in _own_names(self.element) else "efforts"
        try:
            pairs = [(effort, works_on) for effort, works_on in self._called(name)]
        except (TypeError, ValueError):
            raise InputError(
                f"{self.element.__name__}.{name}: expected a list of pairs, an effort and what it works on"
            ) from None
        found = [(self._read(name, effort), self._read(name, works_on)) for effort, works_on in pairs]
        return tuple((effort, x if name == "powers" else self.e.rate(x)) for effort, x in found)

    def event_functions(self) -> tuple[sp.Expr, ...]:
        """The breakpoints of formulas, and those that the class names, or else those of its equations."""
        named = issubclass(self.element, Force) and self.element.event_functions is not Force.event_functions
        own = self.column("event_functions") if named else [x for x in self.e.breakpoints if self.e.in_state(x)]
        return (*self.symbols.event_functions, *(x for x in own if named or x not in self.symbols.event_functions))

    def known(self, stated: Stated) -> Stated:
        """The equations, if all symbols in them mean something."""
        columns = (
            stated.point,
            stated.event_functions,
            stated.position,
            stated.velocity,
            (stated.potential,),
            stated.limits,
            stated.measured,
            stated.rates,
        )
        parts = [x for column in (*columns, *stated.powers) for x in column]
        meant = self.symbols.known()
        for symbol in sorted({symbol for x in parts for symbol in self.e.derivatives.variables(x)} - meant, key=str):
            raise InputError(
                f"{self.element.__name__}: found the symbol {symbol} in its equations, expected fields, markers and time of e"
            )
        return stated

    def _called(self, name: str) -> Any:
        try:
            return getattr(self.element, name)(self.e)
        except InputError as error:
            raise InputError(f"{self.element.__name__}.{name}: {error}") from None
        except Exception as error:
            raise InputError(f"{self.element.__name__}.{name}: {type(error).__name__}: {error}") from error

    def _read(self, name: str, x: Any) -> sp.Expr:
        try:
            return self.e.read(x)
        except (InputError, sp.SympifyError) as error:
            raise InputError(f"{self.element.__name__}.{name}: {error}") from None


def _own_names(element: type[Any]) -> set[str]:
    return {name for owner in element.__mro__ if owner not in (Force, Joint) for name in vars(owner)}
