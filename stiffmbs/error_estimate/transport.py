"""Transport of the error, e' = J e + d, along the recorded steps, by collocation over each of them.

The equations are the variational ones of the run, which hold errors on the constraints, with the defect d as a source. They are
evaluated on the curve through the recorded states, at the points of a Radau method: the rates of errors turn with the bodies, and
stiff parts decay.
"""

from __future__ import annotations

import numpy as np

from ..compile.equations import ABSENT, Equations
from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from ..sensitivity_equations.stages import Stages
from ..solve.formulations import SI2_EXACT
from ..solve.ida.choice import chosen
from ..solve.radau.collocation import radau
from .coordinates import as_rows, typical
from .evaluated import Evaluated
from .parameters import ESTIMATE

OF_BDF = radau(3)
"""Method of the collocation over a step of bdf."""


class Transport:
    """Variational equations of one mechanism, in rows (dq, du, ds).

    `at`: states of the run.
    """

    def __init__(self, dynamics: Dynamics, at: Evaluated) -> None:
        self._dynamics = dynamics
        self._equations = Equations(SI2_EXACT, dynamics.system, dynamics.coordinates)  # errors on the constraints
        self._equations.start_from(at.q[0])
        self._matrix, _ = chosen(self._equations)
        self._weight = self._unknowns(1.0 / typical(dynamics.system, at.q, at.u)[None])[0]
        self._stages: dict[int, Stages] = {}

    def along(
        self, rows: np.ndarray, sizes: np.ndarray, rates: np.ndarray, error: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the errors at the points of steps, from that at their start, and their rates, shape (steps, points, full).

        `rows`: those of the points, shape (steps, points, 2 + 2 unknowns). `sizes`, `rates`, `error`: lengths of the steps, s, defects
        at the points and the error at the start, as (dq, du, ds). Raise a SolverError if the errors are not determined.
        """
        stages, s, found, slopes = self._of(rates.shape[1]), self._unknowns(error[None])[0], [], []
        stages.forget()
        for some in self._parts(rates):
            changes, end = stages.advance(rows[some], sizes[some], self._sources(rates[some]), s)
            self._raise_if_singular(rows[some], len(changes))
            starts = np.concatenate([s[None], s + np.cumsum(changes[:-1, -1], axis=0)])
            found.append(starts[:, None] + changes)
            slopes.append(stages.method.derivative @ changes / sizes[some, None, None])
            s = end
        errors, of_errors = (self._errors(np.concatenate(each)).reshape(rates.shape) for each in (found, slopes))
        return errors, of_errors

    def apart(self, rows: np.ndarray, sizes: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return the errors at the points of steps of which each starts without one; the rest as in `along`."""
        stages, found = self._of(rates.shape[1]), []
        stages.forget()
        for some in self._parts(rates):
            found.append(stages.apart(rows[some], sizes[some], self._sources(rates[some])))
            self._raise_if_singular(rows[some], len(found[-1]))
        return self._errors(np.concatenate(found)).reshape(rates.shape)

    def corrections(self, at: Evaluated, cj: np.ndarray, residuals: np.ndarray) -> np.ndarray:
        """Return the errors x of cj x - J x = residuals at some states, shape (n, full), of which each has its cj."""
        return self.apart(self.rows(at)[:, None], 1.0 / cj, residuals[:, None])[:, 0]

    def tangent(self, at: Evaluated, rates: np.ndarray) -> np.ndarray:
        """Return the part of some rates that is tangent to the constraints at some states, shape (n, full)."""
        cj = 1.0 / np.finfo(float).eps  # in so short a step, only constraints act
        return cj * self.corrections(at, np.full(len(at.t), cj), rates)

    def _parts(self, rates: np.ndarray) -> list[slice]:
        """Return parts of the steps that are in memory at once."""
        count = max(1, ESTIMATE.numbers_at_once // (rates.shape[1] * 2 * self._equations.n))
        return [slice(first, first + count) for first in range(0, len(rates), count)]

    def _sources(self, rates: np.ndarray) -> np.ndarray:
        """Return changes of the unknowns from rows (dq, du, ds) at the points of steps."""
        return self._unknowns(rates.reshape(-1, rates.shape[2])).reshape(*rates.shape[:2], -1)

    def _raise_if_singular(self, rows: np.ndarray, done: int) -> None:
        if done < len(rows):
            raise SolverError(f"a matrix is singular at t = {rows[done, 0, 0]:.6g} s")

    def _of(self, points: int) -> Stages:
        """Return the solver of a number of points."""
        if points not in self._stages:
            self._stages[points] = Stages(
                self._equations, self._dynamics.state, self._matrix, radau(points), self._weight, ESTIMATE.converged
            )
        return self._stages[points]

    def rows(self, at: Evaluated) -> np.ndarray:
        """Return rows of time, order, y and y'."""
        equations, carried = self._equations, self._equations.coordinates
        y, yp = np.zeros((2, len(at.t), equations.n))
        solved = equations.at["lam"] != ABSENT
        y[:, equations.at["lam"][solved]] = at.rows.lam[:, solved]
        for into, of_q, of_u in ((y, at.q, at.u), (yp, at.q_rates, at.acceleration)):
            into[:, equations.independent] = np.hstack([of_q[:, carried.independent], of_u[:, carried.independent_u]])
        return np.column_stack([at.t, np.zeros(len(at.t)), y, yp])

    def _unknowns(self, rows: np.ndarray) -> np.ndarray:
        """Return changes of the unknowns, shape (n, unknowns), from rows (dq, du, ds)."""
        system, carried = self._dynamics.system, self._equations.coordinates
        of_v = system.n_pose + system.n_u
        dq, found = np.zeros((len(rows), system.n_q)), np.zeros((len(rows), self._equations.n))
        dq[:, : system.n_pose], dq[:, system.with_rates] = rows[:, : system.n_pose], rows[:, of_v:]
        du = rows[:, system.n_pose : of_v]
        found[:, self._equations.independent] = np.hstack([dq[:, carried.independent], du[:, carried.independent_u]])
        return found

    def _errors(self, unknowns: np.ndarray) -> np.ndarray:
        """Return rows (dq, du, ds) from changes of the unknowns at points of steps."""
        flat = unknowns.reshape(-1, unknowns.shape[-1])
        return as_rows(self._dynamics.system, *self._equations.rates(flat[:, self._equations.independent]))
