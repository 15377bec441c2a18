"""Many states of a system at once: projected onto the constraints, with their accelerations and output terms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from ..errors import SolverError
from ..solve.stiff_rows import with_stiff_forces
from .coordinates import as_rows, pose_rates


@dataclass(frozen=True, eq=False)
class Evaluated:
    """States on the constraints, and their rates.

    `rows`: output rows, whose q and u are projected. `q_rates`: q' of shape (n, n_q).
    """

    t: np.ndarray
    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    q_rates: np.ndarray
    rows: OutputRows

    def at(self, chosen: np.ndarray | slice) -> Evaluated:
        """Return some of the states."""
        return Evaluated(
            self.t[chosen], self.q[chosen], self.u[chosen], self.acceleration[chosen], self.q_rates[chosen],
            self.rows.at(chosen),
        )  # fmt: skip


def evaluated(
    dynamics: Dynamics, t: np.ndarray, q: np.ndarray, u: np.ndarray, balance: tuple[np.ndarray, float] | None = None
) -> Evaluated:
    """Project states onto the constraints and evaluate them; raise a SolverError if one has no solution.

    `balance`: lengths of the implicit steps that end in these states, shape (n,), s, and a change of forces, relative to the
    largest. The projection changes stiff forces by less than that, if possible.
    """
    system = dynamics.system
    rows = dynamics.report(t, q, u, project=bool(system.n_c))
    if len(rows.t) < len(t):
        raise SolverError(f"no accelerations were found at t = {t[len(rows.t)]:.6g} s")
    if balance and system.n_c:
        rows = with_stiff_forces(dynamics, (q, u), rows, *balance)
    q, u, acceleration = (np.ascontiguousarray(each) for each in (rows.q, rows.u, rows.acceleration))
    q_rates = np.hstack([pose_rates(system, q, u), _trailing_rates(dynamics, t, q, u)])
    return Evaluated(t, q, u, acceleration, q_rates, rows)


def motion(system: System, at: Evaluated) -> np.ndarray:
    """Return the rates of states as rows (dq, du, ds): the change by a unit of time."""
    return as_rows(system, at.q_rates, at.acceleration)


def _trailing_rates(dynamics: Dynamics, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the rates of the coordinates after those of the bodies, shape (n, n_q - n_pose)."""
    rates = dynamics.trailing_rates(t, q, u)
    rates[:, np.flatnonzero(dynamics.system.sampled) + dynamics.system.first_state - dynamics.system.n_pose] = 0.0
    return rates
