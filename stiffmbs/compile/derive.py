"""From an element's equations to every derivative that a solver needs (SymPy).

For C(q, t): J = dC/dq, V = J u + C_t, gamma = -(J u + C_t)_q u - (J u + C_t)_t so that J u' = gamma, and
d(J^T w)/dq for given multipliers w.  For efforts Q_k on coordinates s_k: f = sum (ds_k/dq)^T Q_k, f_q and f_u.
The reaction is the generalised force on the first body, turned into force and torque about the element's point.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from ..describe.element import Force, Joint
from ..describe.request import Request
from ..errors import InputError
from .differentiate import Derivatives
from .frames import SymbolicElement
from .kind import Kind
from .symbols import Symbols, symbols_of


@dataclass(frozen=True)
class Entry:
    """One structurally non-zero entry of a term: its expression and its place in the element's own block.

    `row` and `column` count the element's equations, or its velocities or coordinates, from zero.
    """

    expression: sp.Expr
    row: int
    column: int = 0


@dataclass(frozen=True)
class Derived:
    """All terms of a kind, each a list of its non-zero entries in row order.

    Attributes
    ----------
    n_equations, n_holonomic : int
        Constraint equations of one element, and how many of them, the first, have a position form.
    symbols : Symbols
        What the expressions are written in.
    terms : dict
        By the names of `stiffmbs.compile.terms.TERM_AXES`.
    """

    n_equations: int
    n_holonomic: int
    symbols: Symbols
    terms: dict[str, list[Entry]]


def derive(kind: Kind) -> Derived:
    """Derive all terms of a kind from its equations.

    Raises
    ------
    InputError
        When an equation does not depend on any coordinate.
    """
    symbols = symbols_of(kind)
    if issubclass(kind.element, Joint):
        return _derived_joint(kind, symbols)
    if issubclass(kind.element, Request):
        return Derived(0, 0, symbols, {"request": [Entry(sp.sympify(kind.element.value(symbols.element)), 0)]})
    assert issubclass(kind.element, Force)
    return _derived_force(kind, symbols)


def _derived_joint(kind: Kind, symbols: Symbols) -> Derived:
    e, jacobian = symbols.element, Derivatives().jacobian
    C = sp.Matrix([sp.sympify(equation) for equation in kind.element.position(e)])  # type: ignore[attr-defined]
    rates = sp.Matrix([sp.sympify(equation) for equation in kind.element.velocity(e)])  # type: ignore[attr-defined]
    C_q = jacobian(C, e.q) if C else sp.zeros(0, e.q.rows)
    V = sp.Matrix([*(C_q * e.u + C.diff(e.t) if C else ()), *rates])
    J = jacobian(V, e.u)
    for row in range(J.rows):
        if J[row, :].is_zero_matrix:
            raise InputError(f"found the equation {[*C, *rates][row]} = 0, which depends on no coordinate of a body")
        if J[row, :].free_symbols & set(e.u):
            raise InputError(f"found the equation {[*C, *rates][row]} = 0, expected one that is linear in velocities")
    lam, mu = multipliers("lam", V.rows), multipliers("mu", V.rows)
    V_q = jacobian(V, e.q)
    terms = {
        "C": sp.Matrix([*C, *sp.zeros(len(rates), 1)]), "C_q": C_q, "V": V, "J": J, "V_q": V_q,
        "gamma": -(V_q * e.u + V.diff(e.t)),
        "G_lam": jacobian(J.T * lam, e.q), "G_mu": jacobian(C_q.T * mu[: C.rows, :], e.q),
        "A_q": jacobian(J * e.a + V_q * e.u + V.diff(e.t), e.q),
        "gamma_u": -jacobian(V_q * e.u + V.diff(e.t), e.u),
        "reaction": _reaction(kind, e, -J.T * lam),
        "switch": sp.Matrix(symbols.switches),
    }  # fmt: skip
    entries = {name: _entries(matrix) for name, matrix in terms.items()}
    for name in ("C", "V"):  # kept whole, zeros too: solvers find them by row
        entries[name] = [Entry(terms[name][row], row) for row in range(V.rows)]
    return Derived(V.rows, C.rows, symbols, entries)


def _derived_force(kind: Kind, symbols: Symbols) -> Derived:
    e, jacobian = symbols.element, Derivatives().jacobian
    f = sp.zeros(e.q.rows, 1)
    for effort, coordinate in kind.element.efforts(e):  # type: ignore[attr-defined]
        f += jacobian([coordinate], e.q).T * effort
    joint_lam = [symbol for joint in symbols.joint_lam for symbol in joint]
    terms = {
        "f": f, "f_q": jacobian(f, e.q), "f_u": jacobian(f, e.u),
        "f_lam": jacobian(f, joint_lam) if joint_lam else sp.zeros(0, 0),
        "reaction": _reaction(kind, e, f), "potential": sp.Matrix([kind.element.potential(e)]),  # type: ignore[attr-defined]
        "switch": sp.Matrix([*symbols.switches, *kind.element.switches(e)]),  # type: ignore[attr-defined]
    }  # fmt: skip
    return Derived(0, 0, symbols, {name: _entries(matrix) for name, matrix in terms.items()})


def multipliers(name: str, count: int) -> sp.Matrix:
    """A column of symbols for the multipliers of one element's equations."""
    return sp.Matrix([sp.Symbol(f"{name}{k}", real=True) for k in range(count)])


def _reaction(kind: Kind, e: SymbolicElement, force: sp.Matrix) -> sp.Matrix:
    """Force and torque about the element's point, of the generalised force on its first body."""
    fx, fy, moment = force[0], force[1], force[2]
    arm = sp.Matrix(kind.element.point(e)) - e.frames[0].origin  # type: ignore[attr-defined]
    return sp.Matrix([fx, fy, moment - arm[0] * fy + arm[1] * fx])


def _entries(matrix: sp.Matrix) -> list[Entry]:
    rows, columns = matrix.shape
    every = (Entry(sp.sympify(matrix[r, c]), r, c) for r in range(rows) for c in range(columns))
    return [entry for entry in every if not entry.expression.is_zero]
