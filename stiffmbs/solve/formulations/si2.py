"""Stabilised index 2 (SI2)."""

from __future__ import annotations

from ...compile.equations import Block, Formulation, Product

SI2 = Formulation(
    name="SI2",
    unknowns=("q", "u", "mu", "lam"),
    residual_set="motion",
    matrix_set="tangent",
    residual=(
        Product("q", +1, "I", "q'"), Product("q", -1, "Z", "u"), Product("q", +1, "C_q.T", "mu"),
        Product("u", +1, "M", "u'"), Product("u", -1, "f"), Product("u", +1, "J.T", "lam"),
        Product("mu", +1, "C"),
        Product("lam", +1, "V"),
    ),
    matrix=(
        Block("q", "q", "I", constant=0, cj=1), Block("q", "q", "G_mu"), Block("q", "u", "Z", -1), Block("q", "mu", "C_q.T"),
        Block("u", "u", "M", constant=0, cj=1), Block("u", "q", "f_q", -1), Block("u", "u", "f_u", -1),
        Block("u", "q", "G_lam"), Block("u", "lam", "J.T"), Block("u", "lam", "f_lam", -1),
        Block("mu", "q", "C_q"),
        Block("lam", "q", "V_q"), Block("lam", "u", "J"),
    ),
)  # fmt: skip
"""q' - Z u + C_q^T mu = 0, M u' - f + J^T lam = 0, C = 0, V = J u + C_t = 0: both levels of every constraint hold.

Gear, Gupta, Leimkuhler, Automatic integration of Euler-Lagrange equations with constraints, J. Comput. Appl.
Math. 12-13 (1985) 77-90.
"""
