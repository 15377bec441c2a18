"""From an element's equations to every derivative that a solver needs (SymPy).

For C(q, t): J = dC/dq, V = J u + C_t, gamma = -(J u + C_t)_q u - (J u + C_t)_t so that J u' = gamma, and
d(J^T w)/dq for given multipliers w.  For efforts Q_k on coordinates s_k: f = sum (ds_k/dq)^T Q_k, f_q and f_u.
The reaction is the generalised force on the first body, turned into force and torque about the element's point.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from ..describe.element import Force, Joint
from ..errors import InputError
from .kind import Kind


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
    n_equations : int
        Constraint equations of one element; none for a force.
    terms : dict
        By the names of `stiffmbs.compile.terms.TERM_AXES`.
    """

    n_equations: int
    terms: dict[str, list[Entry]]


def derive(kind: Kind) -> Derived:
    """Derive all terms of a kind from its equations.

    Raises
    ------
    InputError
        When an equation does not depend on any coordinate.
    """
    e, _ = kind.symbolic
    n_equations = 0
    if issubclass(kind.element, Joint):
        C = sp.Matrix([sp.sympify(equation) for equation in kind.element.position(e)])
        n_equations = C.rows
        lam, mu = multipliers("lam", C.rows), multipliers("mu", C.rows)
        J = C.jacobian(e.q)
        for row in range(C.rows):
            if J[row, :].is_zero_matrix:
                raise InputError(f"found the equation {C[row]} = 0, which depends on no coordinate of a body")
        V = J * e.u + C.diff(e.t)
        gamma = -(V.jacobian(e.q) * e.u + V.diff(e.t))
        terms = {
            "C": C, "V": V, "gamma": gamma, "J": J, "V_q": V.jacobian(e.q),
            "G_lam": (J.T * lam).jacobian(e.q), "G_mu": (J.T * mu).jacobian(e.q),
            "reaction": _reaction(kind, -J.T * lam),
        }  # fmt: skip
    else:
        assert issubclass(kind.element, Force)
        f = sp.zeros(e.q.rows, 1)
        for effort, coordinate in kind.element.efforts(e):
            f += sp.Matrix([coordinate]).jacobian(e.q).T * effort
        terms = {
            "f": f, "f_q": f.jacobian(e.q), "f_u": f.jacobian(e.u),
            "reaction": _reaction(kind, f), "potential": sp.Matrix([kind.element.potential(e)]),
        }  # fmt: skip
    return Derived(n_equations, {name: _entries(matrix) for name, matrix in terms.items()})


def multipliers(name: str, count: int) -> sp.Matrix:
    """A column of symbols for the multipliers of one element's equations."""
    return sp.Matrix([sp.Symbol(f"{name}{k}", real=True) for k in range(count)])


def _reaction(kind: Kind, force: sp.Matrix) -> sp.Matrix:
    """Force and torque about the element's point, of the generalised force on its first body."""
    e, _ = kind.symbolic
    fx, fy, moment = force[0], force[1], force[2]
    arm = sp.Matrix(kind.element.point(e)) - e.frames[0].origin  # type: ignore[attr-defined]
    return sp.Matrix([fx, fy, moment - arm[0] * fy + arm[1] * fx])


def _entries(matrix: sp.Matrix) -> list[Entry]:
    rows, columns = matrix.shape
    every = (Entry(sp.sympify(matrix[r, c]), r, c) for r in range(rows) for c in range(columns))
    return [entry for entry in every if not entry.expression.is_zero]
