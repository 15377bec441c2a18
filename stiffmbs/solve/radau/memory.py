"""Memory of a Radau integration and its linear systems."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

from ...compile.equations import ABSENT, Equations
from ...compile.law_intervals import has_kinks
from ...compile.machine.layout import Table, fill, packed
from ...compile.state import State
from ...model.settings import RunSettings
from ...sparse.elimination_order import EliminationOrder
from ...tuning import parameters_of
from ..ida.libraries import Libraries, ida_libraries
from ..ida.session import Session
from ..ida.statistics import COUNTERS
from ..linear_solvers.block_lu import BlockLU
from ..linear_solvers.linear_solver import Assembled, LinearSolver
from .collocation import MOST_BETWEEN, Collocation, radau
from .condensed import condensed_efforts, indices
from .interface import COUNTER, REPEAT, RESOLVES, RadauFunctions
from .native.layouts import COLLOCATION, RADAU

if TYPE_CHECKING:
    from ..cost import ImplicitCost
    from ..ida.ida import NativeIda
    from .parameters import RadauParameters

CHOSEN_FROM = tuple(count for count in get_args(RunSettings.model_fields["stages"].annotation) if count != "auto")
"""Numbers of stages among which a run chooses."""
VECTORS = {"b": 1, "x": 1, "pair_b": 2, "pair_x": 2}
"""Vectors of the linear systems, and their size in numbers of unknowns."""


class Pairs(NamedTuple):
    """Complex matrix as a real one: unknown k is the pair 2 k, 2 k + 1 of its real and imaginary part.

    `matrix`: real matrix of twice the size. `re_re`, `im_im`: entry of each slot of the complex matrix in the pattern
    of the real one. `im_re`, `re_im`: entry of each imaginary part.
    """

    matrix: LinearSolver
    re_re: np.ndarray
    im_im: np.ndarray
    im_re: np.ndarray
    re_im: np.ndarray


def in_pairs(matrix: LinearSolver, imaginary: np.ndarray) -> Pairs:
    """Return a complex matrix whose given slots have an imaginary part, with the linear solver of a real matrix."""
    rows, columns = matrix.rows, matrix.columns
    row, column = rows[imaginary], columns[imaginary]
    all_rows = np.concatenate([2 * rows, 2 * rows + 1, 2 * row + 1, 2 * row])
    all_columns = np.concatenate([2 * columns, 2 * columns + 1, 2 * column, 2 * column + 1])
    order = np.lexsort((all_rows, all_columns))
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    parts = np.split(place, np.cumsum([len(rows), len(rows), len(row)]))
    fields: dict[str, Any] = {"n": 2 * matrix.n, "rows": all_rows[order], "columns": all_columns[order]}
    if isinstance(matrix, BlockLU):
        fields |= {"nodes": matrix.nodes, "kinds": np.repeat(matrix.kinds, 2), "parts": 2}
    return Pairs(type(matrix)(**fields, order=_order_in_pairs(matrix)), *parts)


def pair_cost(matrix: LinearSolver) -> float:
    """Return the estimated cost of a complex matrix, in that of the real one."""
    return replace(matrix, n=2 * matrix.n, order=_order_in_pairs(matrix)).cost / matrix.cost


def _order_in_pairs(matrix: LinearSolver) -> EliminationOrder:
    """Return the elimination order of a complex matrix, with its fill-in: blocks store real and imaginary parts once."""
    own, parts = matrix.order, 2 if isinstance(matrix, BlockLU) else 4
    doubled = (2 * own.unknowns[:, None] + np.arange(2)).ravel()
    return EliminationOrder(doubled, parts * own.fill, 2 * parts * own.updates)


class Radau:
    """Radau methods in place of IDA's BDF (`stiffmbs.solve.ida.connection.Formula`).

    - `matrix`: real iteration matrix with its linear solver.
    - `stages`: number of stages; None to choose it by the convergence of Newton's iteration.
    - `cost`: cost of a residual and of a real iteration matrix.
    - `pair_cost`: cost of a complex matrix, in real ones.
    """

    def __init__(
        self,
        equations: Equations,
        matrix: LinearSolver,
        state: State,
        stages: int | None,
        cost: ImplicitCost,
        parameters: RadauParameters,
    ) -> None:
        self._equations, self._parameters, self._state = equations, parameters, state
        for term_set in ("effort", "effort_tangent"):
            state.load(term_set)
        self._pairs = in_pairs(matrix, equations.slots_with_rates)
        self.pair_cost = pair_cost(matrix)
        methods = CHOSEN_FROM if stages is None else (stages,)
        self._coefficients = {
            count: _arrays(radau(count)) | _costs(count, cost, self.pair_cost, parameters)
            for count in {*methods, *(count - 2 for count in methods)}
        }
        self._tables = {count: packed(COLLOCATION, arrays) for count, arrays in self._coefficients.items()}
        self._methods = methods
        self._most = max(methods)
        self._words = Table(RADAU)
        self.repeat, self.resolves = REPEAT.address, RESOLVES.address

    def libraries(self) -> Libraries:
        """Return the SUNDIALS functions, with those of IDA replaced."""
        return RadauFunctions(ida_libraries().loaded)

    def memory(self, session: Session) -> int:
        """Return the address of the memory."""
        return self._words.ctypes.data

    def counters(self, memory: int, libraries: Libraries) -> np.ndarray:
        """Return the functions of the counters and their arguments, shape (2, counters)."""
        first = memory + self._words.itemsize * list(RADAU).index("steps")
        cells = first + self._words.itemsize * np.arange(len(COUNTERS))
        return np.array([np.full(len(COUNTERS), COUNTER.address), cells])

    def connect(self, ida: NativeIda, session: Session, real: Assembled) -> None:
        """Create matrices and vectors, and fill the memory."""
        equations, n, system = self._equations, self._equations.n, self._equations.system
        self._of_equations = equations.table()
        imaginary = equations.slots_with_rates
        pairs = self._pairs
        vectors = {name: np.zeros(count * n) for name, count in VECTORS.items()}
        at = {f"at_{name}": session.vector(values) for name, values in vectors.items()}
        complexes = [pairs.matrix.assembled(session, at["at_pair_b"]) for _ in range(self._most // 2)]
        solvers = [real, *complexes]
        for each in solvers:
            session.libraries.SUNLinSolInitialize(each.solver)
        number = np.full(len(equations.pattern[0]), -1)
        number[imaginary] = np.arange(len(imaginary))
        algebraic = np.ones(n)
        algebraic[equations.pattern[0][imaginary]] = 0.0
        efforts = condensed_efforts(equations)
        n_terms = len(self._state.values[equations.formulation.matrix_set])
        n_efforts, n_all = efforts["n_efforts"], n + efforts["n_efforts"]
        values = {
            "state": ida.state_table, "equations": self._of_equations[0], "array_of": session.libraries.address("N_VGetArrayPointer"), "n": n, "algebraic": algebraic,
            "methods": self._addresses(0), "below": self._addresses(-2), "n_methods": len(self._methods),
            "setup": session.libraries.address("SUNLinSolSetup"),
            "solve": session.libraries.address("SUNLinSolSolve"),
            "solver": np.array([each.solver for each in solvers]), "matrix": np.array([each.matrix for each in solvers]),
            "values": np.array([each.values for each in solvers]), "n_slots": len(number),
            "re_re": indices(pairs.re_re), "im_im": indices(pairs.im_im),
            "n_imaginary": len(imaginary), "imaginary_of": number.astype(np.int32),
            "im_re": indices(pairs.im_re), "re_im": indices(pairs.re_im),
            "n_terms": n_terms, "terms": np.zeros(n_terms), "terms_aside": np.zeros(n_terms + efforts["n_levers"] + efforts["n_slopes"]),
            "entries": np.zeros(len(number)), **vectors, **at, "output_correction": ida.output_correction.table, "error_norm": ida.error_norm.table,
            "step_bound": ida.step_bound.table,
            **_angles(equations), **_positions(equations), "n_all": n_all, **efforts, "lever": np.zeros(efforts["n_levers"]), "slope": np.zeros(efforts["n_slopes"]),
            "misfit": np.zeros(self._most * n_efforts), "r": np.zeros(self._most * n),
            **{name: np.zeros(n) for name in ("yp", "yp_stage", "error", "weight", "atol")},
            "corrections": np.zeros((self._most - 1 + MOST_BETWEEN) * n_all),
            **{name: np.zeros(n_all) for name in ("y", "y_stage", "y_past")},
            **{name: np.zeros(self._most * n_all) for name in ("z", "d", "past")},
            "has_kinks": int(has_kinks(system)),
            **asdict(parameters_of(self._parameters)),
        }  # fmt: skip
        fill(self._words, values)
        self._kept = values, solvers

    def _addresses(self, more: int) -> np.ndarray:
        """Return the addresses of the tables of the methods, or of those with more stages."""
        return np.array([self._tables[count + more].ctypes.data for count in self._methods])

    def forget(self) -> None:
        """Forget the method chosen in an earlier run, and pivots."""
        cells = self._words.view(RADAU.cells)[0]
        cells["method"], cells["h_factored"] = 0, 0.0
        for each in self._kept[1]:
            each.forget()


def _angles(equations: Equations) -> dict[str, Any]:
    """Return the unknowns that are angles of bodies in the plane, and their angular velocities."""
    of_body, n_pose = equations.system.of_body, equations.system.n_pose
    turning = np.arange(n_pose) % of_body.n_q >= (of_body.linear if of_body.dimensions == 2 else of_body.n_q)
    angle, spin = (equations.at[name][:n_pose][turning[: len(equations.at[name])]] for name in ("q", "u"))
    both = (angle != ABSENT) & (spin != ABSENT)
    return {"n_angles": int(both.sum()), "angle": np.int64(angle[both]), "spin": np.int64(spin[both])}


def _positions(equations: Equations) -> dict[str, Any]:
    """Return the unknowns that are positions of bodies, and those of the velocities along or about the same axis, or `ABSENT`."""
    of_body, n_pose = equations.system.of_body, equations.system.n_pose
    number = np.arange(n_pose) % of_body.n_q
    scalar = (number == of_body.linear) & (of_body.dimensions == 3)  # the first number of a quaternion has no axis
    before = (number > of_body.linear) & (of_body.dimensions == 3)
    place = np.arange(n_pose) // of_body.n_q * of_body.n_u + number - before
    velocity = np.where(scalar, ABSENT, equations.at["u"][place])
    found = equations.at["q"][:n_pose]
    kept = found != ABSENT
    return {
        "n_positions": int(kept.sum()), "position": np.int64(found[kept]), "velocity": np.int64(velocity[kept]),
        "prescribed": np.zeros(int(kept.sum()), dtype=np.int64),
    }  # fmt: skip


def _arrays(c: Collocation) -> dict[str, Any]:
    """Return the contents of the table of a method."""
    arrays = {name: np.ascontiguousarray(value) for name, value in vars(c).items() if isinstance(value, np.ndarray)}
    return {
        **arrays, "stages": c.stages, "pairs": len(c.alpha), "gamma": c.gamma, "n_between": len(c.between),
        "most_between": c.most_between,
    }  # fmt: skip


def _costs(stages: int, cost: ImplicitCost, pair_cost: float, parameters: RadauParameters) -> dict[str, float]:
    """Return the costs of the matrices of a step and of an iteration, and the rate below which matrices are kept."""
    setup = cost.matrix * (1 + pair_cost * (stages // 2))
    iteration = stages * cost.residual + parameters.solution_cost * setup
    return {"setup_cost": setup, "iteration_cost": iteration, "keep": parameters.keep_matrix * setup / iteration}
