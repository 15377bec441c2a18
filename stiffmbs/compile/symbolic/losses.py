"""Power of an element beyond the rate of its potential, and the conditions under which it is zero.

A force has the power sum Q_k v_k of its efforts on the rates of their coordinates, and its potential changes at the
rate V'. The sum of both changes kinetic + potential energy. A joint has the power -lam^T J u, which is lam^T C_t where
J u + C_t = 0 (Lanczos, The Variational Principles of Mechanics, 1970, ch. V.1): zero unless its equations depend on
time.
"""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from .element import SymbolicElement
from .stated import Stated
from .symbols import Symbols

NO_VALUE = (sp.nan, sp.zoo, sp.oo, -sp.oo)


def without(e: SymbolicElement, x: sp.Basic, symbols: frozenset[sp.Symbol]) -> sp.Basic:
    """Return an expression with some symbols set to zero, also in named subexpressions."""
    if isinstance(x, sp.Symbol):
        if x in symbols:
            return sp.Integer(0)
        meaning = e.meanings.get(x)
        return x if meaning is None or not e.depends(x, symbols) else without(e, meaning, symbols)
    return x.func(*(without(e, part, symbols) for part in x.args)) if x.args else x


def power_of_joint(e: SymbolicElement, V: sp.Matrix, lam: sp.Matrix) -> sp.Expr:
    """Return lam^T C_t, with C_t from the velocity level V = J u + C_t at rest."""
    at_rest = frozenset(e.velocities)
    return sp.Add(*(factor * without(e, row, at_rest) for factor, row in zip(lam, V, strict=True)))


def power_of_force(stated: Stated, symbols: Symbols, may_keep: bool = True) -> tuple[sp.Expr, list[int] | None]:
    """Return a force's power beyond the rate of its potential, and the numbers that must be zero for it to vanish.

    Parameters
    ----------
    may_keep : bool
        `Force.may_keep_energy`.

    Returns
    -------
    power : Expr
        W.
    losses : list of int or None
        Numbers of the element, in the order of `ElementData.numbers`; None if unknown.
    """
    e, powers, potential = symbols.element, stated.powers, stated.potential
    work = sp.Add(*(Q * v for Q, v in powers))
    if not may_keep:
        return work if potential == 0 else work + e.rate(potential), None
    if potential == 0:
        vanishes = not work.has(sp.Function) and sp.expand(work) == 0  # products cancel, as in a gyroscopic torque
        return (sp.Integer(0), []) if vanishes else (work, None)
    losses = _losses(symbols, [Q for Q, _ in powers])
    return (sp.Integer(0) if losses == [] else work + e.rate(potential)), losses


def _losses(symbols: Symbols, efforts: list[sp.Expr]) -> list[int] | None:
    """Return the numbers that vanish from efforts at rest, if efforts without them depend on the pose only.

    A force with a potential states the potential of its efforts at rest.
    """
    e = symbols.element
    velocities = frozenset(e.velocities)
    at_rest = [without(e, Q, velocities) for Q in efforts]
    lost = _numbers_in(symbols, efforts) - _numbers_in(symbols, at_rest)
    kept = [without(e, Q, lost) for Q in efforts]
    changing = [e.t, *velocities, *e.states, *symbols.pressed]
    if any(Q.has(*NO_VALUE) or e.depends(Q, changing) for Q in kept):
        return None
    return [k for k, number in enumerate(symbols.numbers) if number in lost]


def _numbers_in(symbols: Symbols, expressions: Iterable[sp.Basic]) -> frozenset[sp.Symbol]:
    found: frozenset[sp.Symbol] = frozenset()
    for expression in expressions:
        found |= symbols.element.derivatives.variables(expression)
    return found & frozenset(symbols.numbers)
