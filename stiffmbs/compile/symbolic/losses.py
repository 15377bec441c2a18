"""The power of an element that the potentials do not count, and when it is zero for certain.

A force has the power sum Q_k v_k of its efforts on the rates of their coordinates, and its potential V changes at the
rate V'; what their sum brings into a mechanism changes kinetic + potential energy.  A joint has the power -lam^T J u,
which is lam^T C_t where J u + C_t = 0 (Lanczos, The Variational Principles of Mechanics, 1970, ch. V.1): none unless its
equations depend on time.
"""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from .element import SymbolicElement
from .stated import Stated
from .symbols import Symbols

NO_VALUE = (sp.nan, sp.zoo, sp.oo, -sp.oo)


def without(e: SymbolicElement, x: sp.Basic, symbols: frozenset[sp.Symbol]) -> sp.Basic:
    """An expression with some symbols set to zero, also in what its own symbols stand for."""
    if isinstance(x, sp.Symbol):
        if x in symbols:
            return sp.Integer(0)
        meaning = e.meanings.get(x)
        return x if meaning is None or not e.depends(x, symbols) else without(e, meaning, symbols)
    return x.func(*(without(e, part, symbols) for part in x.args)) if x.args else x


def power_of_joint(e: SymbolicElement, V: sp.Matrix, lam: sp.Matrix) -> sp.Expr:
    """lam^T C_t, C_t being the velocity level V = J u + C_t at rest."""
    at_rest = frozenset(e.velocities)
    return sp.Add(*(factor * without(e, row, at_rest) for factor, row in zip(lam, V, strict=True)))


def power_of_force(stated: Stated, symbols: Symbols, may_keep: bool = True) -> tuple[sp.Expr, list[int] | None]:
    """A force's power beyond the rate of its potential, and which of its numbers must be zero for it to be zero.

    Parameters
    ----------
    may_keep : bool
        `Force.may_keep_energy`.

    Returns
    -------
    power : Expr
        W.
    losses : list of int or None
        Numbers of the element, in the order of `ElementData.numbers`; None where nothing makes it zero for certain.
    """
    e, powers, potential = symbols.element, stated.powers, stated.potential
    work = sp.Add(*(Q * v for Q, v in powers))
    if not may_keep:
        return work if potential == 0 else work + e.rate(potential), None
    if potential == 0:
        return (sp.Integer(0), []) if _vanishes(work) else (work, None)
    losses = _losses(symbols, [Q for Q, _ in powers])
    return (sp.Integer(0) if losses == [] else work + e.rate(potential)), losses


def _vanishes(work: sp.Expr) -> bool:
    """Whether products cancel, as those of a gyroscopic torque do; other functions take far longer to expand."""
    return not work.has(sp.Function) and sp.expand(work) == 0


def _losses(symbols: Symbols, efforts: list[sp.Expr]) -> list[int] | None:
    """The numbers that efforts lose at rest, where efforts without these depend on the pose alone.

    A force that states a potential states that of its efforts at rest.
    """
    e = symbols.element
    velocities = frozenset(e.velocities)
    at_rest = [without(e, Q, velocities) for Q in efforts]
    lost = _numbers_in(symbols, efforts) - _numbers_in(symbols, at_rest)
    kept = [without(e, Q, lost) for Q in efforts]
    changing = [e.t, *velocities, *e.states, *(symbol for lam in symbols.joint_lam for symbol in lam)]
    if any(Q.has(*NO_VALUE) or e.depends(Q, changing) for Q in kept):
        return None
    return [k for k, number in enumerate(symbols.numbers) if number in lost]


def _numbers_in(symbols: Symbols, expressions: Iterable[sp.Basic]) -> frozenset[sp.Symbol]:
    found: frozenset[sp.Symbol] = frozenset()
    for expression in expressions:
        found |= symbols.element.derivatives.variables(expression)
    return found & frozenset(symbols.numbers)
