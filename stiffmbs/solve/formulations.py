"""Formulations of the residual that the BDF integrator solves, with the names of Adams.

All have the equations of motion q' - Z u = 0 and M u' - f + J^T lam = 0. They differ in the constraints.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..compile.formulation import Block, Formulation, Product
from ..model.settings import RunSettings


def _with_constraints(
    name: str, residual: Sequence[Product], matrix: Sequence[Block], *, corrects: bool = False, integrated: bool = False,
    sets: tuple[str, str] = ("motion", "tangent"), tested: tuple[str, ...] = ("q", "u"),
) -> Formulation:  # fmt: skip
    """Return the equations of motion with lines of constraints.

    `corrects`: true with multipliers mu that correct positions, q' - Z u + C_q^T mu = 0. `integrated`: true if the
    unknowns mu and lam are integrals of the multipliers. `sets`: term sets of residual and matrix.
    """
    prime, (constant, cj) = "'" * integrated, (0.0, 1.0) if integrated else (1.0, 0.0)
    motion = (
        Product("q", +1, "E", "q'"), Product("q", -1, "Z", "u"), Product("q", -1, "rate"),
        *[Product("q", +1, "C_q.T", f"mu{prime}")] * corrects,
        Product("u", +1, "M", "u'"), Product("u", +1, "inertia", "u'"), Product("u", -1, "f"), Product("u", +1, "J.T", f"lam{prime}"),
    )  # fmt: skip
    tangent = (
        Block("q", "q", "E", constant=0, cj=1), *[Block("q", "q", "G_mu")] * corrects, Block("q", "u", "Z", -1), Block("q", "q", "Z_q", -1),
        Block("q", "q", "rate_q", -1), Block("q", "u", "rate_u", -1), Block("q", "lam", "rate_lam", -constant, -cj),
        *[Block("q", "mu", "C_q.T", constant, cj)] * corrects,
        Block("u", "u", "M", constant=0, cj=1), Block("u", "u", "inertia", constant=0, cj=1), Block("u", "q", "inertia_q"), Block("u", "q", "f_q", -1), Block("u", "u", "f_u", -1),
        Block("u", "q", "G_lam"), Block("u", "lam", "J.T", constant, cj), Block("u", "lam", "f_lam", -constant, -cj),
    )  # fmt: skip
    unknowns = ("q", "u", "mu", "lam") if corrects else ("q", "u", "lam")
    return Formulation(name, unknowns, *sets, (*motion, *residual), (*tangent, *matrix), tested, integrated)


I3 = _with_constraints(
    "I3",
    (Product("lam", +1, "C"), Product("lam", +1, "V:rates")),
    (Block("lam", "q", "C_q"), Block("lam", "q", "C_x"), Block("lam", "q", "V_q:rates"), Block("lam", "u", "J:rates")),
    tested=("q",),
)
"""Index 3: position constraints C = 0 only; velocity errors are not controlled.

Orlandea, Chace, Calahan, A sparsity-oriented approach to the dynamic analysis and design of mechanical systems, J. Eng.
Ind. 99 (1977) 773-784.
"""

_RESIDUAL = Product("mu", +1, "C"), Product("lam", +1, "V")
_MATRIX = Block("mu", "q", "C_q"), Block("mu", "q", "C_x"), Block("lam", "q", "V_q"), Block("lam", "u", "J")
SI2_EXACT = _with_constraints("SI2_exact", _RESIDUAL, _MATRIX, corrects=True)
"""Stabilised index 2: position and velocity constraints C = 0 and V = J u + C_t = 0; the multipliers mu correct positions.

Gear, Gupta, Leimkuhler, Automatic integration of Euler-Lagrange equations with constraints, J. Comput. Appl. Math.
12-13 (1985) 77-90.
"""
SI2 = _with_constraints(
    "SI2",
    (*_RESIDUAL, Product("mu", -1, "E_mu", "mu"), Product("lam", -1, "E_lam", "lam")),
    (*_MATRIX, Block("mu", "mu", "E_mu", -1), Block("lam", "lam", "E_lam", -1)),
    corrects=True,
)
"""SI2 with C - E_mu mu = 0 and V - E_lam lam = 0: constraint drift far below the tolerance in place of exact rows.

The iteration matrix is then never singular: the integrator passes singular poses, and redundant equations need no
removal. mu is zero for the exact solution, so C stays at rounding. V deviates by E_lam lam, which is dissipative.
"""
SI1 = _with_constraints("SI1", _RESIDUAL, _MATRIX, corrects=True, integrated=True)
"""SI2 with the multipliers as derivatives of new unknowns, which reduces the index to 1.

Gear, Differential-algebraic equation index transformations, SIAM J. Sci. Stat. Comput. 9 (1988) 39-47.
"""


def index1(stabilisation: float) -> Formulation:
    """Return index 1, constraints of accelerations: J u' - gamma + 2 b V + b^2 C = 0.

    Baumgarte, Stabilization of constraints and integrals of motion in dynamical systems, Comput. Methods Appl. Mech.
    Eng. 1 (1972) 1-16. `stabilisation`: b, the decay rate of violations, 1/s; with 0 they are not stabilised.
    """
    b = stabilisation
    return _with_constraints(
        "index1",
        (Product("lam", +1, "J", "u'"), Product("lam", -1, "gamma"), Product("lam", 2 * b, "V"), Product("lam", b * b, "C")),
        (
            Block("lam", "q", "A_q"), Block("lam", "u", "gamma_u", -1), Block("lam", "u", "J", constant=2 * b, cj=1),
            Block("lam", "q", "V_q", 2 * b), Block("lam", "q", "C_q", b * b), Block("lam", "q", "C_x", b * b),
        ),
        sets=("all_levels", "all_levels_tangent"),
    )  # fmt: skip


FORMULATIONS: dict[str, Callable[[RunSettings], Formulation]] = {
    "SI2": lambda settings: SI2,
    "SI2_exact": lambda settings: SI2_EXACT,
    "SI1": lambda settings: SI1,
    "I3": lambda settings: I3,
    "index1": lambda settings: index1(settings.stabilisation),
}
"""Formulations by their name in the settings."""
