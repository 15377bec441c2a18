"""Names of the kernel terms, sets of terms computed together, and kernel arguments.

Symbols: docs/project/notation.md.
"""

from __future__ import annotations

_OF_CONSTRAINTS = ("C_q", "C_x", "J", "V_q", "G_lam")
_OF_FORCES_AND_STATES = ("f_q", "f_u", "f_lam", "Z", "Z_q", "rate_q", "rate_u", "rate_lam", "inertia", "inertia_q")
"""Derivatives in every iteration matrix."""
TERM_SETS: dict[str, tuple[str, ...]] = {
    "position": ("C", "C_q", "continuous_angle"),
    "motion": ("C", "V", "C_q", "J", "f", "Z", "rate", "inertia"),
    "tangent": (*_OF_CONSTRAINTS, "G_mu", *_OF_FORCES_AND_STATES),
    "acceleration": ("J", "gamma", "f_lam", "angle_rate", "f", "f_alg", "rate", "inertia", "rate_alg", "rate_lam"),
    "output": ("reaction", "potential", "power", "measured", "signal", "kinetic"),
    "event_function": ("event_function", "limit", "argument"),
    "effort": ("effort", "lever"),
    "effort_tangent": ("effort_q", "effort_u"),
    "all_levels": ("C", "V", "J", "gamma", "f", "Z", "rate", "inertia"),
    "all_levels_tangent": (*_OF_CONSTRAINTS, "A_q", "gamma_u", *_OF_FORCES_AND_STATES),
}
"""Terms requested together, so that common subexpressions are computed once. f, rate and inertia have the same places in
motion and acceleration: most forces and states share one kernel.

- C: constraints; C_q = dC/dq of bodies; C_x = dC/dx of user states; G_mu = d(C_q^T mu)/dq.
- V: velocity level, C_q u + C_t and nonholonomic equations; J = dV/du; V_q = dV/dq; G_lam = d(J^T lam)/dq.
- gamma: J u' on the constraints; gamma_u = dgamma/du and A_q = d(J a - gamma)/dq for given accelerations a.
- f: applied forces; f_q, f_u, f_lam: derivatives (friction depends on multipliers).
- Z: matrix of q' = Z u where q' is not u itself; Z_q = d(Z u)/dq.
- inertia: entries of the mass matrix besides its diagonal; inertia_q: derivatives of these times the accelerations a.
- rate: x' of a user state (residual of an algebraic one); rate_q, rate_u, rate_lam: derivatives.
- f_alg, rate_alg: columns of f_q and rate_q of algebraic states.
- effort: efforts of forces that may be very stiff, on rates along their own directions; lever: derivatives of these
  rates by velocities, with f = lever^T effort; effort_q, effort_u: derivatives of the efforts.
- continuous_angle: angles with turn counters; angle_rate: their rates.
- reaction: force and torque on the first body; measured: other channels of a kind; signal: reported value of a state.
- potential: energy; kinetic: energy of the entries `inertia`; power: power into kinetic + potential energy (`stiffmbs.compile.symbolic.derive`).
- event_function: zero at breakpoints of a force; limit: positive while a force law is valid.
- argument: arguments of tables and functions with narrow features (exp, tanh).
"""

TERM_AXES: dict[str, str] = {
    "C": "c", "V": "c", "gamma": "c", "f": "u", "reaction": "r", "measured": "m", "potential": "e", "power": "e", "signal": "e", "event_function": "s", "limit": "s",
    "argument": "s",
    "C_q": "cq", "C_x": "cq", "J": "cu", "V_q": "cq", "G_lam": "uq", "G_mu": "qq", "f_q": "uq", "f_u": "uu", "f_lam": "ul",
    "A_q": "cq", "gamma_u": "cu", "Z": "qu", "Z_q": "qq", "continuous_angle": "q", "angle_rate": "q",
    "rate": "q", "rate_q": "qq", "rate_u": "qu", "rate_lam": "ql",
    "f_alg": "uq", "rate_alg": "qq", "inertia": "uu", "inertia_q": "uq", "kinetic": "e",
    "effort": "p", "lever": "pu", "effort_q": "pq", "effort_u": "pu",
}  # fmt: skip
"""Axes of each term: c own equations, p own efforts; u velocities, q coordinates, l equations of joints referred to, r reaction
components, m channels of a kind, s event functions, e elements."""

KERNEL_ARGUMENTS = "count, index, number, t, q, turn, u, a, lam, mu, place, value"
KERNEL_SIGNATURE = "void(int64, int64*, float64*, float64, float64*, float64*, float64*, float64*, float64*, float64*, int64*, float64*)"
"""Arguments of every kernel: the number of elements; `index` and parameters; time; q, shared orientation values
(`stiffmbs.compile.bodies`), u, accelerations and multipliers; `place`, the kind's first equation and the first value of
each term; and the values, which are output."""

TURNED = "turn["
"""Text in the source of a kernel that reads shared orientation values."""
