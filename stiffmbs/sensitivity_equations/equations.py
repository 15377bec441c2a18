"""Variational equations of a system, and their steps (`stiffmbs.sensitivity_equations.native.variations`)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..compile.directional.direction import Direction, Numbers, unchanged
from ..compile.directional.source import NUMBER, TIME
from ..compile.equations import Equations
from ..compile.machine.layout import packed
from ..compile.machine.routines import together
from ..compile.state import State
from ..compile.terms import TERM_SETS
from ..errors import SolverError
from ..solve.ida.libraries import ida_libraries
from ..solve.ida.session import Session
from ..solve.linear_solvers.linear_solver import LinearSolver
from .native.layouts import DEPTH, PART, VARIATIONS

ADVANCE, WITHIN, DEFECTS = together(
    "stiffmbs.sensitivity_equations.native.variations",
    advance="int64(int64, float64*, int64*)",
    within="int64(float64*, float64*, int64*)",
    defects="int64(float64*, float64*, float64*, int64*)",
)
FUNCTIONS = {"setup": "SUNLinSolSetup", "solve": "SUNLinSolSolve"}


class VariationalEquations:
    """Variational equations r_y s + r_y' s' + r_p = 0 for several directions p, along given steps.

    `equations` are those of the run, in its order of unknowns; `matrix` has the storage and linear solver of its iteration
    matrix, and `directions` are variations of the parameters of the system.
    """

    def __init__(self, equations: Equations, matrix: LinearSolver, state: State, directions: Sequence[Numbers]) -> None:
        self.equations, self._count = equations, len(directions)
        n = equations.n
        self._session = Session(ida_libraries())
        self._vectors = {name: np.zeros(n) for name in ("defect", "correction")}
        handles = {f"at_{name}": self._session.vector(values) for name, values in self._vectors.items()}
        assembled = matrix.assembled(self._session, handles["at_defect"])
        libraries = self._session.libraries
        libraries.SUNLinSolInitialize(assembled.solver)
        row, column = (part.astype(np.int32) for part in equations.pattern)
        formulation = equations.formulation
        state.load(formulation.residual_set)
        state.load(formulation.matrix_set)
        self._parts = [_Part(equations, state, numbers, NUMBER) for numbers in directions]
        self._by_time, self._shift = _Part(equations, state, unchanged(state.system), TIME), np.zeros(len(directions))
        share = np.setdiff1d(state.system.turned(formulation.residual_set), state.system.turned(formulation.matrix_set))
        table, slots = equations.table()
        self._history, self._times = np.zeros((DEPTH, len(directions), n)), np.zeros(DEPTH)
        values = {
            "state": state.restricted(equations.used()), "equations": table, "n": n, "n_directions": len(directions), "n_slots": len(row),
            "row": row, "column": column,
            "constant": np.zeros(len(row)), "rate": np.zeros(len(row)), "n_share": len(share), "share": share,
            "parts": np.array([part.table.ctypes.data for part in self._parts], dtype=np.int64),
            "by_time": self._by_time.table, "shift": self._shift, "of_time": np.zeros(n),
            **{name: libraries.address(function) for name, function in FUNCTIONS.items()},
            "solver": assembled.solver, "matrix": assembled.matrix, "entries": assembled.values,
            **self._vectors, **handles, "s": np.zeros(n), "rates": np.zeros(n),
            "history": self._history, "times": self._times, "weight": np.zeros(DEPTH), "slope": np.zeros(DEPTH),
        }  # fmt: skip
        self._table = packed(VARIATIONS, values)
        self._kept = values, slots, assembled, handles
        self._cells, self._at = self._table.view(VARIATIONS.cells)[0], self._table.ctypes.data

    def close(self) -> None:
        """Free the objects of SUNDIALS."""
        self._session.close()

    def shift(self, shift: np.ndarray) -> None:
        """Integrate s + y' times the given shifts from now on, s, shape (directions,)."""
        self._shift[:] = shift
        self._cells["shifted"] = bool(shift.any())

    def begin(self, t: float, first_step: float, s: np.ndarray, rates: np.ndarray) -> None:
        """Start from given s and s', shapes (directions, n); `first_step` is the length of the first step, s."""
        self._history[0], self._times[0] = s - first_step * rates, t - first_step
        self._history[1], self._times[1] = s, t
        self._cells["newest"] = 1

    def advance(self, steps: np.ndarray) -> None:
        """Integrate over recorded steps: rows of time, order, y and y', shape (steps, 1, 2 + 2 n).

        Raise a SolverError when the matrix of a step is singular.
        """
        rows = np.ascontiguousarray(steps[:, -1])
        done = self._session.call(ADVANCE.call, len(rows), rows.ctypes.data, self._at)
        if done < len(rows):
            raise singular(rows[done, 0])

    def within(self, row: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return s at a time within the next step, shape (directions, n).

        `row` has time, y and y' there; `step` is as for `advance`.
        """
        out, row = np.empty((self._count, self.equations.n)), np.array(row)
        row[1] = step[-1, 1]
        if self._session.call(WITHIN.call, row.ctypes.data, out.ctypes.data, self._at):
            raise singular(row[0])
        return out

    def defects(self, row: np.ndarray, s: np.ndarray) -> np.ndarray:
        """Return r_y s + r_p at a state, shape (directions, n)."""
        out, row, given = np.empty_like(s), np.ascontiguousarray(row), np.ascontiguousarray(s)
        self._session.call(DEFECTS.call, row.ctypes.data, given.ctypes.data, out.ctypes.data, self._at)
        return out

    @property
    def last(self) -> np.ndarray:
        """s at the end of the last step, shape (directions, n)."""
        return self._history[int(self._cells["newest"])].copy()


def singular(t: float) -> SolverError:
    """Return the error of a singular matrix."""
    return SolverError(
        f"sensitivities: found a singular matrix at t = {t:.9g} s, expected a pose at which the motion is unique"
    )


class _Part:
    """Residual derivative r_p in one direction: the kernels that depend on it, and the places of their values."""

    def __init__(self, equations: Equations, state: State, numbers: Numbers, along: str) -> None:
        system, term_set = state.system, equations.formulation.residual_set
        self._direction = Direction(state, term_set, numbers, (along,))
        written = np.zeros(len(self._direction.values), dtype=bool)
        for g in self._direction.writes:
            group = system.groups[g]
            for k, term in enumerate(TERM_SETS[term_set]):
                first = system.places[term_set][g, 1 + k]
                written[first : first + group.count * group.entries[term]] = True
        masses = system.constants(term_set)["M"] + np.flatnonzero(numbers.mass)
        written[masses] = True
        kept = written[equations._r_source]
        n_plain, n_with_y, n_with_yp = (
            int(kept[:end].sum()) for end in (equations._n_plain, equations._n_with_y, equations._n_with_yp)
        )
        lines = equations._r_row, equations._r_source, equations._r_operand, equations._r_factor
        self._arrays = [np.ascontiguousarray(part[kept]) for part in lines]
        self.table = packed(
            PART,
            {
                "direction": self._direction.table, "n_plain": n_plain, "n_with_y": n_with_y, "n_with_yp": n_with_yp,
                **dict(zip(("row", "source", "operand", "factor"), self._arrays, strict=True)),
            },
        )  # fmt: skip
