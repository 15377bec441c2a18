"""Equations of a linearly implicit Euler step, and memory for it, shared with compiled code."""

from __future__ import annotations

import numpy as np

from ...compile.equations import Equations
from ...compile.formulation import Block, Formulation, Product
from ...compile.machine.layout import packed
from ...compile.machine.routines import together
from ...dynamics.dynamics import Dynamics
from ...errors import InputError
from ..ida.choice import chosen
from ..linear_solvers.linear_solver import Memory
from ..linear_solvers.sparse_lu import SparseLU
from .native.layouts import LINEARLY_IMPLICIT

STEP = Formulation(
    name="linearly implicit step",
    unknowns=("u", "s", "lam"),
    residual_set="motion",
    matrix_set="tangent",
    residual=(Product("u", +1, "f"), Product("s", +1, "rate"), Product("s", +1, "Z", "u"), Product("lam", -1, "V")),
    matrix=(
        Block("u", "u", "M", constant=0, cj=1), Block("u", "u", "inertia", constant=0, cj=1), Block("u", "u", "f_u", -1), Block("u", "u", "f_q", -1),
        Block("u", "s", "f_q", -1), Block("u", "lam", "J.T"),
        Block("s", "s", "E", constant=0, cj=1), Block("s", "s", "rate_q", -1), Block("s", "u", "rate_u", -1), Block("s", "u", "rate_q", -1), Block("s", "u", "Z", -1),
        Block("lam", "u", "J"),
    ),
)  # fmt: skip
"""[M/h - f_u - h f_q Z, -f_q, J^T; -rate_u - h rate_q Z, E/h - rate_q, 0; J + h V_q Z, V_q, 0] [du; ds; lam] = [f; rate; -V].

It is evaluated at the positions q + h Z u, so that those of bodies change by h Z du and are condensed; s are all other
coordinates, of which turn counters have the rates Z u, and cj = 1/h. The constraints of velocities hold after the step, and those of positions up to h^2 |du|.
"""
LINEAR_STEP, ARRAY_OF = together(
    "stiffmbs.solve.explicit.native.linearly_implicit",
    linear_step="int32(float64, float64, int64*)",
    array_of="int64(int64)",
)


class LinearlyImplicit:
    """Memory of linearly implicit steps of a system.

    `table`: addresses for compiled code (`stiffmbs.solve.explicit.native.layouts.LINEARLY_IMPLICIT`).
    """

    def __init__(self, dynamics: Dynamics, columns: int) -> None:
        system = dynamics.system
        by_reactions = [f"forces.{name}" for name in system.forces_by_reactions]
        by_reactions += [
            f"states.{system.states[k - system.first_state]}"
            for k in sorted({*system.term("tangent", "rate_lam").row.tolist()})
        ]
        if by_reactions:
            raise InputError(
                f"A linearly implicit step does not know reactions of joints at its start, on which {' and '.join(by_reactions)} depend; "
                "use solver bdf or radau, or scheme rk4"
            )
        for term_set in ("motion", "tangent"):
            dynamics.state.load(term_set)
        self._equations = equations = Equations(STEP, system)
        solver, _ = chosen(equations)
        self._solver = memory = solver.memory(ARRAY_OF.address)
        if memory.needed:
            memory.known["setup_pivots"], memory.known["solve_pivots"] = SparseLU.factor.address, SparseLU.solve.address
        self._equations_table, self._lists = equations.table()
        n = system.n_q + system.n_u
        self._arrays = {
            "state": dynamics.state.restricted(equations.used()), "equations": self._equations_table, "columns": columns,
            "setup": solver.factor.address, "solve": solver.solve.address, "solver": np.array([memory.content.ctypes.data]),
            "entries": memory.factors["a"], **_cells(memory), "b": np.zeros(equations.n), "x": np.zeros(equations.n),
            "start": np.zeros(n), "whole": np.zeros(n),
        }  # fmt: skip
        self.table = packed(LINEARLY_IMPLICIT, self._arrays)
        self._row = self.table.view(LINEARLY_IMPLICIT.cells)[0]
        self.forget()

    def forget(self) -> None:
        """Forget that earlier steps did not resolve a growth."""
        self._row["unresolved"] = np.nan

    @property
    def unresolved(self) -> float:
        """Time of the first step that did not resolve a growth, s; NaN if there is none."""
        return float(self._row["unresolved"])


def _cells(memory: Memory) -> dict[str, np.ndarray]:
    """Return the cells of a linear solver by name, as arrays; the pivots of a sparse LU always depend on earlier ones."""
    words, fields = np.frombuffer(memory.known, dtype=np.int64), dict(memory.known.dtype.fields or {})
    depends = np.ones(1, dtype=np.int64)
    return {
        name: words[fields[name][1] // 8 :] if name in fields else depends for name in ("ready", "refused", "refined")
    }
