"""CasADi: IDAS on absolute coordinates and multipliers, CVODES where there are none; Jacobians by CasADi."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..contestant import Contestant, Failed, Solve
from ..task import Task
from .absolute import Maths, constraints, forces
from .mechanism import Mechanism, mechanism_of
from .segments import segments_of

MOST_STEPS = 10**7
OUT_OF_THE_TEST = 1e8
"""Absolute tolerance of multipliers: suppressed instead, SI2 does not start at tolerances below 1e-9."""
BAUMGARTE = 10.0
"""Rate of the stabilisation in index 1, 1/s: of 0, 10 and 100 the fastest at an error of 1e-6 on most problems."""


def contestants(task: Task) -> Iterator[Contestant]:
    """IDAS in SI2 and in index 1; CVODES where there are no joints."""
    m = mechanism_of(task.scene)
    if not m.pins:
        yield Contestant("CasADi CVODES", True, lambda rtol: integration(free(m), m, task, rtol))
        return
    yield Contestant("CasADi IDAS SI2", True, lambda rtol: integration(si2(m), m, task, rtol))
    yield Contestant("CasADi IDAS index 1", True, lambda rtol: integration(index_1(m), m, task, rtol))


def maths() -> Maths:
    """CasADi's functions."""
    import casadi as ca

    return Maths(ca.sin, ca.cos, ca.sqrt, ca.fmin, ca.fmax)


def _symbols(m: Mechanism) -> tuple[Any, ...]:
    """t, q, u, f and C."""
    import casadi as ca

    q, u, t = ca.SX.sym("q", m.n), ca.SX.sym("u", m.n), ca.SX.sym("t")
    f = forces(m, t, ca.vertsplit(q), ca.vertsplit(u), maths())
    return t, q, u, ca.vertcat(*f), ca.vertcat(*constraints(m, ca.vertsplit(q), maths()))


def free(m: Mechanism) -> dict[str, Any]:
    """Bodies without joints."""
    import casadi as ca

    t, q, u, f, _ = _symbols(m)
    return {"t": t, "x": ca.vertcat(q, u), "ode": ca.vertcat(u, f / m.mass)}


def si2(m: Mechanism) -> dict[str, Any]:
    """Gear, Gupta and Leimkuhler's index-2 form: x = (q, u), z = (lambda, mu)."""
    import casadi as ca

    t, q, u, f, C = _symbols(m)
    J = ca.jacobian(C, q)
    lam, mu = ca.SX.sym("lam", C.size1()), ca.SX.sym("mu", C.size1())
    ode = ca.vertcat(u - J.T @ mu, (f - J.T @ lam) / m.mass)
    return {"t": t, "x": ca.vertcat(q, u), "z": ca.vertcat(lam, mu), "ode": ode, "alg": ca.vertcat(C, J @ u)}


def index_1(m: Mechanism, rate: float = BAUMGARTE) -> dict[str, Any]:
    """Accelerations' constraints with Baumgarte's stabilisation at a rate, 1/s: x = (q, u), z = lambda."""
    import casadi as ca

    t, q, u, f, C = _symbols(m)
    J, lam = ca.jacobian(C, q), ca.SX.sym("lam", C.size1())
    acceleration = (f - J.T @ lam) / m.mass
    closing = J @ acceleration + ca.jtimes(J @ u, q, u) + 2 * rate * (J @ u) + rate**2 * C
    return {"t": t, "x": ca.vertcat(q, u), "z": lam, "ode": ca.vertcat(u, acceleration), "alg": closing}


def consistent(equations: dict[str, Any], m: Mechanism) -> tuple[np.ndarray, np.ndarray]:
    """z and x' at a start at rest: [M J^T; J 0][u'; lambda] = [f; 0], mu = 0."""
    import casadi as ca
    from scipy.sparse import block_array, diags_array
    from scipy.sparse.linalg import spsolve

    _, q, u, f, C = _symbols(m)
    at_start = ca.Function("at_start", [q, u], [f, ca.jacobian(C, q)])
    force, J = (part.sparse() for part in at_start(m.start, np.zeros(m.n)))
    right = np.concatenate([force.toarray().ravel(), np.zeros(J.shape[0])])
    found = spsolve(block_array([[diags_array(m.mass), J.T], [J, None]], format="csc"), right)
    z = np.concatenate([found[m.n :], np.zeros(equations["z"].size1() - J.shape[0])])
    return z, np.concatenate([np.zeros(m.n), found[: m.n]])


def integration(equations: dict[str, Any], m: Mechanism, task: Task, rtol: float) -> Solve:
    """Integrate from breakpoint to breakpoint."""
    import casadi as ca

    joined, z_start = "z" in equations, np.zeros(0)
    options: dict[str, Any] = {"reltol": rtol, "abstol": rtol, "max_num_steps": MOST_STEPS, "newton_scheme": "direct"}
    if joined:
        z_start, rates = consistent(equations, m)
        tolerances = np.r_[np.full(2 * m.n, rtol), np.full(len(z_start), OUT_OF_THE_TEST)]
        options |= {"abstolv": tolerances.tolist(), "calc_ic": False, "init_xdot": rates.tolist()}
    plugin = "idas" if joined else "cvodes"
    segments = [
        (ca.integrator("segment", plugin, equations, times[0], times[1:].tolist(), options), count)
        for times, count in segments_of(task.times, task.breakpoints)
    ]

    def solve() -> np.ndarray:
        x, z, rows = np.concatenate([m.start, np.zeros(m.n)]), z_start, [m.start[None]]
        for segment, count in segments:
            try:
                found = segment(x0=x, z0=z)
            except RuntimeError as error:
                raise Failed(str(error).splitlines()[-1]) from None
            states = np.asarray(found["xf"]).T
            rows.append(states[:count, : m.n])
            x, z = states[-1], np.asarray(found["zf"])[:, -1] if joined else z
        return np.concatenate(rows)

    return solve
