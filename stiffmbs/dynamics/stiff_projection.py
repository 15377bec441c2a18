"""Projection of states onto the constraints that does not change stiff forces.

The smallest move onto the constraints also moves the ends of stiff springs. A move of 1e-12 m changes a force of
1e14 N/m by 100 N. Moves with the matrix of an implicit step avoid that.
"""

from __future__ import annotations

import numpy as np

from ..compile.formulation import Block, Formulation, Product
from ..compile.machine.layout import address, addresses
from ..compile.machine.object_code import SHORT
from ..compile.machine.routines import together
from .dynamics import Dynamics
from .native.parameters import CONSISTENCY
from .saddle_point import saddle_points

FORCE_CHANGES, PROJECT = together(
    "stiffmbs.dynamics.native.stiff_projection",
    SHORT,
    force_changes="void(int64, float64*, float64*, float64*, float64*, float64*, int64, int64*, int64*, float64*, float64*, float64*, int64*)",
    project_stiffly="int64(float64, float64, float64*, int64*, int64*, int64*, int64*)",
)
_MATRIX = (
    Block("u", "u", "M", constant=0, cj=1), Block("u", "u", "inertia", constant=0, cj=1), Block("u", "u", "f_u", -1), Block("u", "q", "f_q", -1),
    Block("u", "lam", "J.T"), Block("lam", "u", "J"),
    Block("q", "u", "Z", -1), Block("q", "q", "I", constant=0, cj=1),
)  # fmt: skip
_POSITIONS, _VELOCITIES = (
    Formulation(f"{level} by an implicit step", ("u", "lam", "q"), "motion", "tangent", (Product("u", +1, "f"), Product("lam", -1, level)), _MATRIX)
    for level in "CV"
)  # fmt: skip
"""[cj M - f_u, J^T, -f_q; J, 0, 0; -Z, 0, cj I] [v; w; dq] = [d; -C or -V; 0]. d restores forces. v is the change of u, or Z v that of q."""


class StiffProjection:
    """Projection of single states, and the changes of forces by projections.

    - `dynamics`: its state is used as memory.
    """

    def __init__(self, dynamics: Dynamics) -> None:
        self._state, system = dynamics.state, dynamics.system
        for term_set in ("motion", "tangent"):
            self._state.load(term_set)
        self._systems = saddle_points(self._state, _POSITIONS, _VELOCITIES)
        positions, velocities = self._systems
        self._at_state = address(self._state.table)
        self._tables = addresses(positions.equations_table, velocities.equations_table, positions.factors_table)
        forces = system.term("motion", "f")
        self._forces = np.array(forces.source, dtype=np.int64), np.array(forces.row, dtype=np.int64)
        self._work = np.empty(system.n_u)

    def force_changes(
        self, t: np.ndarray, before: tuple[np.ndarray, np.ndarray], after: tuple[np.ndarray, np.ndarray]
    ) -> np.ndarray:
        """Return the largest change of a force between states (q, u) at some times, divided by roots of inertias."""
        changes = np.empty(len(t))
        states = [np.ascontiguousarray(array, dtype=float) for array in (t, *before, *after)]
        weight = 1.0 / np.sqrt(self._state.system.mass)
        at_rest = addresses(*self._forces, weight, self._work, changes)
        FORCE_CHANGES.call(len(t), *addresses(*states), len(self._forces[0]), *at_rest, self._at_state)
        return changes

    def forget_pivots(self) -> None:
        """Discard the pivot sequences, so that the rounding of a run does not depend on earlier runs."""
        for each in self._systems:
            each.forget_pivots()

    def project(self, t: float, step: float, q: np.ndarray, u: np.ndarray) -> bool:
        """Project a state within a step, s, in place, by the matrix of a shorter implicit step; return False on failure."""
        state = self._state
        state.q[:], state.u[:] = q, u
        status = PROJECT.short_call(
            t, CONSISTENCY.step_parts / step, address(self._work), *self._tables, self._at_state
        )
        q[:], u[:] = state.q, state.u
        return status == 0 and bool(np.isfinite(q).all() and np.isfinite(u).all())
