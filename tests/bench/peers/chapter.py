"""The plain solver of a textbook: SymPy's equations by `lambdify`, NumPy's solutions, Euler-Cromer with projection.

Nikravesh, Computer-Aided Analysis of Mechanical Systems (1988), ch. 13, for the block system and its use in each step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ..contestant import Contestant, Failed, Solve
from ..task import Task
from .absolute import Maths, constraints, forces
from .mechanism import Mechanism, mechanism_of

MOST_COORDINATES = 30
CLOSE = 1e-12
"""Largest violation of a position constraint after projection."""
MOST_CORRECTIONS = 20
STEPS = tuple(10.0 ** np.arange(-1.5, -5.1, -0.25))


def contestants(task: Task) -> Iterator[Contestant]:
    """Fixed steps; for mechanisms whose full matrices are small."""
    m = mechanism_of(task.scene)
    if m.n <= MOST_COORDINATES:
        spacing = task.times[1] - task.times[0]
        parts = sorted({max(1, round(spacing / step)) for step in STEPS})
        yield Contestant(
            "lambdify and NumPy", True, lambda step: marching(m, task.times, step), "step",
            tuple(spacing / part for part in parts),
        )  # fmt: skip


@dataclass(frozen=True)
class Functions:
    """Functions of (t, q, u): C, J, gamma = -J' u, and f."""

    C: Callable[..., np.ndarray]
    J: Callable[..., np.ndarray]
    gamma: Callable[..., np.ndarray]
    f: Callable[..., np.ndarray]


def functions(m: Mechanism) -> Functions:
    """Derived by SymPy."""
    import sympy as sp

    t, q, u = sp.Symbol("t"), sp.symbols(f"q:{m.n}"), sp.symbols(f"u:{m.n}")
    maths = Maths(sp.sin, sp.cos, sp.sqrt, sp.Min, sp.Max)
    C, v = sp.Matrix(constraints(m, q, maths)), sp.Matrix(u)
    J = C.jacobian(q) if len(C) else sp.zeros(0, m.n)
    gamma = -((J * v).jacobian(q) * v) if len(C) else sp.zeros(0, 1)
    f = sp.Matrix(forces(m, t, q, u, maths))
    C, J, gamma, f = (sp.lambdify((t, q, u), part, "numpy", cse=True) for part in (C, J, gamma, f))
    return Functions(C, J, gamma, f)


def marching(m: Mechanism, times: np.ndarray, step: float) -> Solve:
    """Steps of one length, a whole number of them between two output times."""
    equations, count = functions(m), round((times[1] - times[0]) / step)
    block = np.zeros((m.n + len(equations.C(0.0, m.start, m.start)),) * 2)
    block[: m.n, : m.n] = np.diag(m.mass)

    def correction(q: np.ndarray, u: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Of [M J^T; J 0][x; lambda] = right the part x."""
        J = equations.J(0.0, q, u).reshape(-1, m.n)
        block[m.n :, : m.n], block[: m.n, m.n :] = J, J.T
        return np.linalg.solve(block, right)[: m.n]

    def projected(q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        for _ in range(MOST_CORRECTIONS):
            C = equations.C(0.0, q, u).ravel()
            if np.max(np.abs(C), initial=0.0) < CLOSE:
                break
            q = q + correction(q, u, np.concatenate([np.zeros(m.n), -C]))
        else:
            raise Failed("the projection does not converge")
        return q, correction(q, u, np.concatenate([m.mass * u, np.zeros(len(block) - m.n)]))

    def solve() -> np.ndarray:
        q, u, rows = m.start, np.zeros(m.n), [m.start]
        for k in range((len(times) - 1) * count):
            t = times[0] + k * step
            right = np.concatenate([equations.f(t, q, u).ravel(), equations.gamma(t, q, u).ravel()])
            u = u + step * correction(q, u, right)
            q, u = projected(q + step * u, u)
            if (k + 1) % count == 0:
                rows.append(q)
        return np.array(rows)

    return solve
