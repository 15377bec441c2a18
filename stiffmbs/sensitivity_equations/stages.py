"""Variational equations by collocation over the points of recorded steps (`stiffmbs.sensitivity_equations.native.stages`)."""

from __future__ import annotations

import numpy as np

from ..compile.equations import Equations
from ..compile.machine.layout import packed
from ..compile.machine.routines import Routine, together
from ..compile.state import State
from ..solve.explicit.linearly_implicit import ARRAY_OF
from ..solve.linear_solvers.linear_solver import LinearSolver
from ..solve.linear_solvers.sparse_lu import SparseLU
from ..solve.radau.collocation import Collocation
from ..solve.radau.memory import in_pairs
from ..sparse.elimination_order import EliminationOrder
from .native.layouts import STAGES

SIGNATURE = "int64(int64, float64*, float64*, float64*, float64*, float64*, float64, int64*)"
ADVANCE, APART = together("stiffmbs.sensitivity_equations.native.stages", advance=SIGNATURE, apart=SIGNATURE)


class Stages:
    """Solver of r_y s + r_y' s' = r_y' d by collocation.

    Parameters
    ----------
    equations
        Equations r(t, y, y') = 0 of the run.
    state
        State of their system.
    matrix
        Linear solver of matrices with their pattern.
    method
        Radau method of the points.
    weight : ndarray, shape (n,)
        Weights of the unknowns in the size of a correction.
    tolerance
        Size of the last correction, relative to the change of s over the step.
    """

    def __init__(
        self, equations: Equations, state: State, matrix: LinearSolver, method: Collocation, weight: np.ndarray,
        tolerance: float,
    ) -> None:  # fmt: skip
        self.method, self._tolerance = method, tolerance
        n, stages = equations.n, method.stages
        state.load(equations.formulation.residual_set)
        state.load(equations.formulation.matrix_set)
        row, column = equations.pattern
        own, coupling, rows, columns = _pattern(equations, stages)
        order = matrix.order
        unknowns = (order.unknowns[:, None] * stages + np.arange(stages)).ravel()  # stages of an unknown are neighbours
        of_stages = EliminationOrder(unknowns, order.fill * stages**2, order.updates * stages**3)
        pairs = in_pairs(matrix, equations.slots_with_rates)
        whole = SparseLU(n * stages, rows, columns, of_stages).memory(0)
        apart = [each.memory(ARRAY_OF.address) for each in (matrix, *[pairs.matrix] * len(method.alpha))]
        for memory in apart:
            if memory.needed:
                memory.known["setup_pivots"], memory.known["solve_pivots"] = (
                    SparseLU.factor.address,
                    SparseLU.solve.address,
                )
        table, slots = equations.table()
        lists = {
            "row": row, "column": column, "own": own, "coupled": equations.slots_with_rates, "coupling": coupling,
            "re_re": pairs.re_re, "im_im": pairs.im_im, "im_re": pairs.im_re, "re_im": pairs.re_im,
        }  # fmt: skip
        values = {
            "state": state.restricted(equations.used()), "equations": table, "n": n, "stages": stages, "n_slots": len(row),
            **{name: np.zeros(stages * len(row)) for name in ("constant", "rate")},
            **{name: np.zeros(len(row)) for name in ("mean_constant", "mean_rate")},
            "n_coupled": len(equations.slots_with_rates), "whole": whole.arrays["factors"], "whole_entries": whole.arrays["entries"],
            "setup": matrix.factor.address, "solve": matrix.solve.address,
            "solvers": np.array([each.content.ctypes.data for each in apart]),
            "values": np.array([each.factors["a"].ctypes.data for each in apart]),
            **{name: np.ascontiguousarray(getattr(method, name)) for name in ("derivative", "transform", "inverse")},
            "real": np.append(method.gamma, method.alpha), "imaginary": np.append(0.0, method.beta), "weight": weight,
            **{name: np.zeros(n * stages) for name in ("residual", "apart", "correction")},
            "pair": np.zeros(2 * n), "solution": np.zeros(2 * n), "slope": np.zeros(n), "sum": np.zeros(n),
            **{name: np.ascontiguousarray(each, dtype=np.int32) for name, each in lists.items()},
        }  # fmt: skip
        self._table = packed(STAGES, values)
        self._kept, self._memories = (values, slots), (whole, *apart)

    def forget(self) -> None:
        """Forget the factors of earlier steps, and their pivots."""
        self._table.view(STAGES.cells)[0]["h"] = 0.0
        for memory in self._memories:
            memory.known["ready"] = 0

    def advance(
        self, points: np.ndarray, sizes: np.ndarray, rates: np.ndarray, s: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Integrate over some steps; return S_i - s at their points, shape (done, stages, n), and s at the end of the last one.

        Only steps before a singular matrix are done.

        Parameters
        ----------
        points : ndarray, shape (steps, stages, 2 + 2 n)
            Time, order, y and y'.
        sizes : ndarray, shape (steps,)
            Lengths of the steps, s.
        rates : ndarray, shape (steps, stages, n)
            d at the points.
        s : ndarray, shape (n,)
            At the start.
        """
        return self._integrated(ADVANCE, points, sizes, rates, s)

    def apart(self, points: np.ndarray, sizes: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return S_i at the points of steps of which each starts at s = 0; the rest as in `advance`."""
        return self._integrated(APART, points, sizes, rates, np.zeros(rates.shape[2]))[0]

    def _integrated(
        self, routine: Routine, points: np.ndarray, sizes: np.ndarray, rates: np.ndarray, s: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        changes, s = np.empty_like(rates), s.copy()
        points, sizes, rates = (np.ascontiguousarray(each) for each in (points, sizes, rates))
        addresses = (each.ctypes.data for each in (points, sizes, rates, s, changes))
        done = routine.call(len(sizes), *addresses, self._tolerance, self._table.ctypes.data)
        return changes[:done], s


def _pattern(equations: Equations, stages: int) -> tuple[np.ndarray, ...]:
    """Return the entries of the matrix of all stages for its slots, for the coupled ones, and its rows and columns."""
    row, column = (each.astype(np.int64) for each in equations.pattern)
    coupled, size, stage = equations.slots_with_rates, equations.n * stages, np.arange(stages)
    own = (column * stages + stage[:, None]) * size + row * stages + stage[:, None]
    i, j = stage[:, None, None], stage[None, :, None]
    coupling = (column[coupled] * stages + j) * size + row[coupled] * stages + i
    places, inverse = np.unique(np.concatenate([own.ravel(), coupling.ravel()]), return_inverse=True)
    return inverse[: own.size], inverse[own.size :], places % size, places // size
