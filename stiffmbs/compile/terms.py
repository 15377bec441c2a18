"""What kernels compute: the names of the terms, the sets computed together, and the arguments of a kernel."""

from __future__ import annotations

TERM_SETS: dict[str, tuple[str, ...]] = {
    "position": ("C", "J"),
    "motion": ("C", "V", "J", "f"),
    "tangent": ("J", "V_q", "G_lam", "G_mu", "f_q", "f_u"),
    "acceleration": ("J", "gamma", "f"),
    "output": ("reaction", "potential"),
}
"""What a solver asks for at one time, so that common subexpressions are computed once.

C constraints, V = J u + C_t, J = dC/dq, f applied forces, V_q = dV/dq, G_w = d(J^T w)/dq, f_q, f_u derivatives of f,
gamma = J u' on the constraints, reaction = force and torque on the first body, potential = energy.
"""

TERM_AXES: dict[str, str] = {
    "C": "c", "V": "c", "gamma": "c", "f": "u", "reaction": "r", "potential": "e",
    "J": "cu", "V_q": "cq", "G_lam": "uq", "G_mu": "qq", "f_q": "uq", "f_u": "uu",
}  # fmt: skip
"""What a term's row and column count: c equations, u velocities, q coordinates, r the parts of a reaction, e elements."""

KERNEL_ARGUMENTS = "count, index, number, t, q, u, lam, mu, place, value"
KERNEL_SIGNATURE = "void(int64, int64*, float64*, float64, float64*, float64*, float64*, float64*, int64*, float64*)"
"""Arguments of every kernel: the number of elements; for each element and body the offsets in q and u; parameters;
time and state; `place`, the kind's first equation and the first value of each term; the values, written."""
