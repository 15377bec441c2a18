"""Index 3 (I3)."""

from ...compile.formulation import Block, Formulation, Product

I3 = Formulation(
    name="I3",
    unknowns=("q", "u", "lam"),
    residual_set="motion",
    matrix_set="tangent",
    residual=(
        Product("q", +1, "E", "q'"), Product("q", -1, "Z", "u"), Product("q", -1, "rate"),
        Product("u", +1, "M", "u'"), Product("u", +1, "inertia", "u'"), Product("u", -1, "f"), Product("u", +1, "J.T", "lam"),
        Product("lam", +1, "C"), Product("lam", +1, "V:rates"),
    ),
    matrix=(
        Block("q", "q", "E", constant=0, cj=1), Block("q", "u", "Z", -1), Block("q", "q", "Z_q", -1),
        Block("q", "q", "rate_q", -1), Block("q", "u", "rate_u", -1), Block("q", "lam", "rate_lam", -1),
        Block("u", "u", "M", constant=0, cj=1), Block("u", "u", "inertia", constant=0, cj=1), Block("u", "q", "inertia_q"), Block("u", "q", "f_q", -1), Block("u", "u", "f_u", -1),
        Block("u", "q", "G_lam"), Block("u", "lam", "J.T"), Block("u", "lam", "f_lam", -1),
        Block("lam", "q", "C_q"), Block("lam", "q", "C_x"), Block("lam", "q", "V_q:rates"), Block("lam", "u", "J:rates"),
    ),
    tested=("q",),
)  # fmt: skip
"""q' - Z u = 0, M u' - f + J^T lam = 0, C = 0: position constraints only; velocity errors are not controlled.

Orlandea, Chace, Calahan, A sparsity-oriented approach to the dynamic analysis and design of mechanical systems, J. Eng.
Ind. 99 (1977) 773-784.
"""
