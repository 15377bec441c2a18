"""What kernels compute: the names of the terms, the sets computed together, and the arguments of a kernel."""

from __future__ import annotations

_OF_CONSTRAINTS = ("C_q", "C_x", "J", "V_q", "G_lam")
_OF_FORCES_AND_STATES = ("f_q", "f_u", "f_lam", "Z", "Z_q", "rate_q", "rate_u", "rate_lam")
"""Derivatives that go into every iteration matrix."""
TERM_SETS: dict[str, tuple[str, ...]] = {
    "position": ("C", "C_q", "continuous_angle"),
    "motion": ("C", "V", "C_q", "J", "f", "Z", "rate"),
    "tangent": (*_OF_CONSTRAINTS, "G_mu", *_OF_FORCES_AND_STATES),
    "acceleration": ("J", "gamma", "f", "f_lam", "angle_rate", "rate", "f_alg", "rate_alg", "rate_lam"),
    "output": ("reaction", "potential", "power", "measured", "signal"),
    "event_function": ("event_function", "limit", "argument"),
    "all_levels": ("C", "V", "J", "gamma", "f", "Z", "rate"),
    "all_levels_tangent": (*_OF_CONSTRAINTS, "A_q", "gamma_u", *_OF_FORCES_AND_STATES),
}
"""What a solver asks for at one time, so that common subexpressions are computed once.

C constraints, C_q = dC/dq of bodies, C_x = dC/dx by states of the user's own, V the velocity level (C_q u + C_t, and equations that have no position form), J = dV/du,
f applied forces, V_q = dV/dq, G_lam = d(J^T lam)/dq, G_mu = d(C_q^T mu)/dq, f_q, f_u, f_lam derivatives of f (forces
of friction depend on multipliers), gamma = J u' on the constraints, reaction = force and torque on the first body,
A_q = d(J a - gamma)/dq and gamma_u = dgamma/du for given accelerations a, Z of q' = Z u where that is not u itself and
Z_q = d(Z u)/dq, rate = x' of a state of the user's own and rate_q, rate_u, rate_lam its derivatives,
f_alg and rate_alg the columns of f_q and rate_q that belong to algebraic states (whose rate is what has to be zero),
continuous_angle = angles that count turns and angle_rate = their rates, potential = energy, power = what an element brings
into kinetic + potential energy (`stiffmbs.compile.symbolic.losses`), measured = what a kind reports of its elements besides
their wrench, signal = what is reported of states,
event_function = what changes its sign at breakpoints of a force, limit = what is above zero for as long as a force's law holds,
argument = what tables and functions with narrow features (exp, tanh) are called with.
"""

TERM_AXES: dict[str, str] = {
    "C": "c", "V": "c", "gamma": "c", "f": "u", "reaction": "r", "measured": "m", "potential": "e", "power": "e", "signal": "e", "event_function": "s", "limit": "s",
    "argument": "s",
    "C_q": "cq", "C_x": "cq", "J": "cu", "V_q": "cq", "G_lam": "uq", "G_mu": "qq", "f_q": "uq", "f_u": "uu", "f_lam": "ul",
    "A_q": "cq", "gamma_u": "cu", "Z": "qu", "Z_q": "qq", "continuous_angle": "q", "angle_rate": "q",
    "rate": "q", "rate_q": "qq", "rate_u": "qu", "rate_lam": "ql",
    "f_alg": "uq", "rate_alg": "qq",
}  # fmt: skip
"""What a term's row and column count: c own equations, u velocities, q coordinates, l equations of the joints that are
referred to, r parts of a reaction, m channels of a kind, s event functions, e elements."""

KERNEL_ARGUMENTS = "count, index, number, t, q, turn, u, a, lam, mu, place, value"
KERNEL_SIGNATURE = "void(int64, int64*, float64*, float64, float64*, float64*, float64*, float64*, float64*, float64*, int64*, float64*)"
"""Arguments of every kernel: the number of elements; for each element and body the offsets in q and u; parameters;
time, q, what kernels share of each body's orientation (`stiffmbs.compile.bodies`), u, accelerations and multipliers;
`place`, the kind's first equation and the first value of each term; the values, written."""

TURNED = "turn["
"""In the source of a kernel that reads what is shared of its bodies' orientations."""
