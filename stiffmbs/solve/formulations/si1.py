"""Stabilised index 1 (SI1)."""

from ...compile.formulation import Block, Formulation, Product

SI1 = Formulation(
    name="SI1",
    unknowns=("q", "u", "mu", "lam"),
    residual_set="motion",
    matrix_set="tangent",
    residual=(
        Product("q", +1, "E", "q'"), Product("q", -1, "Z", "u"), Product("q", -1, "rate"), Product("q", +1, "C_q.T", "mu'"),
        Product("u", +1, "M", "u'"), Product("u", +1, "inertia", "u'"), Product("u", -1, "f"), Product("u", +1, "J.T", "lam'"),
        Product("mu", +1, "C"),
        Product("lam", +1, "V"),
    ),
    matrix=(
        Block("q", "q", "E", constant=0, cj=1), Block("q", "q", "G_mu"), Block("q", "u", "Z", -1), Block("q", "q", "Z_q", -1),
        Block("q", "q", "rate_q", -1), Block("q", "u", "rate_u", -1), Block("q", "lam", "rate_lam", constant=0, cj=-1),
        Block("q", "mu", "C_q.T", constant=0, cj=1),
        Block("u", "u", "M", constant=0, cj=1), Block("u", "u", "inertia", constant=0, cj=1), Block("u", "q", "inertia_q"), Block("u", "q", "f_q", -1), Block("u", "u", "f_u", -1),
        Block("u", "q", "G_lam"), Block("u", "lam", "J.T", constant=0, cj=1),
        Block("u", "lam", "f_lam", constant=0, cj=-1),
        Block("mu", "q", "C_q"), Block("mu", "q", "C_x"),
        Block("lam", "q", "V_q"), Block("lam", "u", "J"),
    ),
    integrated=True,
)  # fmt: skip
"""SI2 with the multipliers as derivatives of new unknowns, which reduces the index to 1.

Gear, Differential-algebraic equation index transformations, SIAM J. Sci. Stat. Comput. 9 (1988) 39-47.
"""
