"""Stabilised index 2 (SI2), relaxed and exact.

Gear, Gupta, Leimkuhler, Automatic integration of Euler-Lagrange equations with constraints, J. Comput. Appl. Math.
12-13 (1985) 77-90. Position and velocity constraints hold; the multipliers mu correct positions.
"""

from ...compile.formulation import Block, Formulation, Product

_RESIDUAL = (
    Product("q", +1, "E", "q'"), Product("q", -1, "Z", "u"), Product("q", -1, "rate"), Product("q", +1, "C_q.T", "mu"),
    Product("u", +1, "M", "u'"), Product("u", +1, "inertia", "u'"), Product("u", -1, "f"), Product("u", +1, "J.T", "lam"),
    Product("mu", +1, "C"),
    Product("lam", +1, "V"),
)  # fmt: skip
_MATRIX = (
    Block("q", "q", "E", constant=0, cj=1), Block("q", "q", "G_mu"), Block("q", "u", "Z", -1), Block("q", "q", "Z_q", -1),
    Block("q", "q", "rate_q", -1), Block("q", "u", "rate_u", -1), Block("q", "lam", "rate_lam", -1), Block("q", "mu", "C_q.T"),
    Block("u", "u", "M", constant=0, cj=1), Block("u", "u", "inertia", constant=0, cj=1), Block("u", "q", "inertia_q"), Block("u", "q", "f_q", -1), Block("u", "u", "f_u", -1),
    Block("u", "q", "G_lam"), Block("u", "lam", "J.T"), Block("u", "lam", "f_lam", -1),
    Block("mu", "q", "C_q"), Block("mu", "q", "C_x"),
    Block("lam", "q", "V_q"), Block("lam", "u", "J"),
)  # fmt: skip

SI2_EXACT = Formulation("SI2_exact", ("q", "u", "mu", "lam"), "motion", "tangent", _RESIDUAL, _MATRIX)
"""q' - Z u + C_q^T mu = 0; M u' - f + J^T lam = 0; C = 0; V = J u + C_t = 0."""

SI2 = Formulation(
    "SI2",
    ("q", "u", "mu", "lam"),
    "motion",
    "tangent",
    (*_RESIDUAL, Product("mu", -1, "E_mu", "mu"), Product("lam", -1, "E_lam", "lam")),
    (*_MATRIX, Block("mu", "mu", "E_mu", -1), Block("lam", "lam", "E_lam", -1)),
)
"""SI2 with C - E_mu mu = 0 and V - E_lam lam = 0: constraint drift far below the tolerance in place of exact rows.

The iteration matrix is then never singular: the integrator passes singular poses, and redundant equations need no
removal. mu is zero for the exact solution, so C stays at rounding. V deviates by E_lam lam, which is dissipative.
"""
