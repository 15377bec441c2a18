"""Index 1: constraints at acceleration level."""

from __future__ import annotations

from ...compile.formulation import Block, Formulation, Product


def index1(stabilisation: float) -> Formulation:
    """Return the formulation q' - Z u = 0; M u' - f + J^T lam = 0; J u' - gamma + 2 b V + b^2 C = 0.

    Baumgarte, Stabilization of constraints and integrals of motion in dynamical systems, Comput. Methods Appl. Mech.
    Eng. 1 (1972) 1-16. `stabilisation`: b, the decay rate of violations, 1/s; with 0 they are not stabilised.
    """
    b = stabilisation
    return Formulation(
        name="index1",
        unknowns=("q", "u", "lam"),
        residual_set="all_levels",
        matrix_set="all_levels_tangent",
        residual=(
            Product("q", +1, "E", "q'"), Product("q", -1, "Z", "u"), Product("q", -1, "rate"),
            Product("u", +1, "M", "u'"), Product("u", +1, "inertia", "u'"), Product("u", -1, "f"), Product("u", +1, "J.T", "lam"),
            Product("lam", +1, "J", "u'"), Product("lam", -1, "gamma"),
            Product("lam", 2 * b, "V"), Product("lam", b * b, "C"),
        ),
        matrix=(
            Block("q", "q", "E", constant=0, cj=1), Block("q", "u", "Z", -1), Block("q", "q", "Z_q", -1),
            Block("q", "q", "rate_q", -1), Block("q", "u", "rate_u", -1), Block("q", "lam", "rate_lam", -1),
            Block("u", "u", "M", constant=0, cj=1), Block("u", "u", "inertia", constant=0, cj=1), Block("u", "q", "inertia_q"), Block("u", "q", "f_q", -1), Block("u", "u", "f_u", -1),
            Block("u", "q", "G_lam"), Block("u", "lam", "J.T"), Block("u", "lam", "f_lam", -1),
            Block("lam", "q", "A_q"), Block("lam", "u", "gamma_u", -1), Block("lam", "u", "J", constant=2 * b, cj=1),
            Block("lam", "q", "V_q", 2 * b), Block("lam", "q", "C_q", b * b), Block("lam", "q", "C_x", b * b),
        ),
    )  # fmt: skip
