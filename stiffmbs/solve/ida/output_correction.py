"""Memory of Newton's iteration on interpolated states (`stiffmbs.solve.ida.native.output_correction`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...compile.equations import ABSENT, Equations
from ...compile.machine.layout import Table, fill
from ...dynamics.dynamics import Dynamics
from ..linear_solvers.linear_solver import Assembled, LinearSolver
from .native.layouts import OUTPUT_CORRECTION
from .session import Session

if TYPE_CHECKING:
    from .ida import NativeIda

VECTORS = "y", "yp", "defect", "correction", "weight", "size", "zero"


class OutputCorrection:
    """Matrix, factors and vectors for the correction of interpolated states; created for the first stiff scene.

    `table`, `cells`: table for compiled code (`stiffmbs.solve.ida.native.layouts.OUTPUT_CORRECTION`), filled by `make_ready`, and
    its cells, which starts set. A state stays unchanged if forces on each body balance up to the part `balanced` of the largest,
    also with closed joints.
    """

    def __init__(self, equations: Equations) -> None:
        self._equations = equations
        self.table = Table(OUTPUT_CORRECTION)
        self.cells = self.table.view(OUTPUT_CORRECTION.cells)[0]
        self.cells["long"] = np.inf
        self._assembled: Assembled | None = None
        self._vectors: dict[str, np.ndarray] = {}

    @property
    def ready(self) -> bool:
        """Return True if the memory exists."""
        return self._assembled is not None

    def make_ready(self, ida: NativeIda, session: Session, matrix: LinearSolver, dynamics: Dynamics) -> None:
        """Create the matrix, its solver and the vectors. `session`: their owner. `dynamics`: dynamics of the same state."""
        libraries, assembled = session.libraries, matrix.assembled(session, ida.y_vector)
        libraries.SUNLinSolInitialize(assembled.solver)
        vectors = {name: np.zeros(self._equations.n) for name in VECTORS}
        force_row, force_end = _rows_of_motion(self._equations)
        joint_row, pose = _rows_of_joints(self._equations), np.zeros(self._equations.system.n_q)
        functions = {
            "interpolate": "IDAGetDky", "weights": "IDAGetErrWeights", "predict": "IDAComputeY", "predict_rate": "IDAComputeYp",
            "setup": "SUNLinSolSetup", "solve": "SUNLinSolSolve",
        }  # fmt: skip
        fill(
            self.table,
            {
                "memory": ida.memory,
                **{name: libraries.address(function) for name, function in functions.items()},
                "solver": assembled.solver, "matrix": assembled.matrix,
                "entries": assembled.values,
                "force_row": force_row, "force_end": force_end,
                "n_joint_rows": len(joint_row), "joint_row": joint_row, "dynamics": dynamics.table, "pose": pose,
                **vectors, **{f"at_{name}": session.vector(values) for name, values in vectors.items()},
            },
        )  # fmt: skip
        self._assembled, self._vectors = assembled, vectors  # the table keeps all other arrays

    def note(self) -> str:
        """Return a sentence on states that could not be corrected; empty if there are none."""
        count, first = int(self.cells["failed"]), float(self.cells["first_failed"])
        return (
            f"coordinates are interpolated at {count} output time{'s' * (count > 1)} from t = {first:.6g} s on, where stiff forces "
            f"do not balance: they and reactions may be wrong there; reduce rtol{', or use solver: radau' * self.ready}"
        ) * (count > 0)

    def forget(self) -> None:
        """Discard the factors and their pivots, and the number of states that could not be corrected."""
        self.cells["factored"], self.cells["failed"] = 0.0, 0
        if self._assembled is not None:
            self._assembled.forget()


def _rows_of_motion(equations: Equations) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows of the equations of motion, forces before moments, and the end of either part."""
    rows = equations.at["u"]
    straight = equations.system.per_velocity(1.0, 0.0) == 1.0
    kinds = [rows[of_kind & (rows != ABSENT)] for of_kind in (straight, ~straight)]
    return np.concatenate(kinds).astype(np.int64), np.cumsum([len(kind) for kind in kinds]).astype(np.int64)


def _rows_of_joints(equations: Equations) -> np.ndarray:
    """Return the rows of single position constraints; none if constraints are those of accelerations."""
    kinds = [line.rows for line in equations.formulation.residual if line.block == "C" and line.factor == 1]
    rows = [equations.at[kind] for kind in kinds]
    found = np.concatenate([np.empty(0), *rows])
    return found[found != ABSENT].astype(np.int64)
