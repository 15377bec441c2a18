"""Dynamics of a system at a state: assembly, projections, accelerations and output rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol, TypeVar, TypeVarTuple, cast

import numpy as np

from ..compile.coordinates import Coordinates, all_independent
from ..compile.inputs.ends import InputEnd, first_input_end
from ..compile.inputs.features import NO_FEATURES, InputFeatures, aside, input_features
from ..compile.machine.layout import address, addresses, packed
from ..compile.machine.object_code import SHORT
from ..compile.machine.routines import together
from ..compile.state import State
from ..compile.system import System
from .native.layouts import DYNAMICS, JUDGED, LINES
from .native.parameters import CONSISTENCY, ELIMINATION
from .saddle_point import ACCELERATIONS, POSITION_STEP, VELOCITY_STEP, WITH_ALGEBRAIC_STATES, saddle_points
from .storage import all_finite, allocated, blocks, release

if TYPE_CHECKING:
    from .elimination.eliminated import Eliminated

T = TypeVar("T")
Settings = TypeVarTuple("Settings")
ASSEMBLE, CORRECT_VELOCITIES, ACCELERATE, TRAILING_RATES, FACTOR_AND_SOLVE, OUTPUT_POINTS = together(
    "stiffmbs.dynamics.native.dynamics",
    SHORT,
    assemble="int64(float64, float64, int64, int64*)",
    correct_velocities="int64(float64, int64*)",
    accelerate="int64(float64, float64*, int64*)",
    trailing_rates="int64(int64, float64*, float64*, float64*, float64*, int64*)",
    factor_and_solve="int64(float64*, int64*)",
    output_points="int64(int64, float64*, float64*, float64*, int64, float64, int64, float64*, float64*, float64*, float64*, float64*, float64*, int64*)",
)


@dataclass(frozen=True, eq=False)
class OutputRows:
    """Output rows, one per output time. Columns are contiguous.

    - `values`: output terms (`stiffmbs.compile.terms`).
    - `kinetic`, `potential`, `power` of shape (n,): energies, J, and the power of non-conservative forces, W.
    - `position_violation`, `velocity_violation`, `drift`: largest violation of a joint (norm over its equations): of C,
      of J u + C_t, and of C before projection.
    - `log_determinant` of shape (n,): log |det| of [M J^T; J 0], without the logarithms of units: small near singular
      poses.
    - `changed`, `moved`, `moved_velocity` of shape (n,): largest changes by the projection, of a velocity, m/s or rad/s, and of
      positions and velocities times roots of inertias.
    - `status`: failure after the last row (`stiffmbs.dynamics.storage`), or 0.
    """

    t: np.ndarray
    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    lam: np.ndarray
    values: np.ndarray
    position_violation: np.ndarray
    velocity_violation: np.ndarray
    drift: np.ndarray
    log_determinant: np.ndarray
    changed: np.ndarray
    moved: np.ndarray
    moved_velocity: np.ndarray
    kinetic: np.ndarray
    potential: np.ndarray
    power: np.ndarray
    status: int

    def at(self, instants: np.ndarray | slice) -> OutputRows:
        """Return the rows of some output times, by number."""
        return OutputRows(**{name: each if name == "status" else each[instants] for name, each in vars(self).items()})

    @property
    def finite(self) -> bool:
        """True if all values that enter channels are finite."""
        return all_finite(
            self.q, self.u, self.acceleration, self.values, self.kinetic, self.potential, self.position_violation,
            self.velocity_violation,
        )  # fmt: skip


class VariedInput(Protocol):
    """Input whose value changes formulas of time (`stiffmbs.studies.varied_input`)."""

    def catch_up(self) -> None:
        """Give elements the current values before their features are determined."""

    def is_calm(self, t: float, end: float) -> bool:
        """Return True if features are not determined, but a step between two times, s, is known to meet none."""


class Dynamics:
    """Block systems of one state, and the compiled routines that use them.

    - `coordinates`: coordinates that integrators may take as unknowns, by default all. The block systems always contain
      all, so that every reaction is computed.
    - `state`: current q, u and lam.
    - `table`: addresses for compiled code.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.coordinates: Coordinates = all_independent(system)
        self.state = State(system)
        for term_set in ("motion", "acceleration", "output"):
            self.state.load(term_set)
        joints = np.array([bool(group.record.n_equations) for group in system.groups], dtype=bool)
        self._constraining = self.state.restricted({"motion": joints, "acceleration": joints})
        algebraic = system.algebraic_coordinates.astype(np.int64)
        self._positions, self._velocities, self._accelerations = saddle_points(
            self.state, POSITION_STEP, VELOCITY_STEP, WITH_ALGEBRAIC_STATES if len(algebraic) else ACCELERATIONS
        )
        self._made: dict[object, tuple[object, object]] = {}
        counters, states = system.term("acceleration", "angle_rate"), system.term("acceleration", "rate")
        source, row = np.append(counters.source, states.source), np.append(counters.row, states.row)
        moving = ~np.isin(row, algebraic)
        self._trailing = source[moving].astype(np.int64), row[moving].astype(np.int64)
        self._widths = system.n_q, system.n_u, system.n_u, system.n_c, system.n_values("output"), len(JUDGED)
        judging: dict[str, np.ndarray] = {}
        counts: dict[str, int] = {}
        for name in ("potential", "power", "kinetic"):
            judging[name] = np.array(system.term("output", name).source, dtype=np.int64)
            counts[f"n_{name}"] = len(judging[name])
        self.input_changes = 0
        self._varied: VariedInput | None = None
        self._features = np.inf, -np.inf, NO_FEATURES
        self._input_end: tuple[float, float, InputEnd | None] = np.nan, np.nan, None
        for_output = system.turned("output")
        self._lists = {
            "algebraic": algebraic,
            "algebraic_scale": system.state_scales[system.algebraic],
            "algebraic_before": np.zeros(len(algebraic)),
            "trailing_source": self._trailing[0],
            "trailing_row": self._trailing[1],
            "turned_for_output": for_output[~np.isin(for_output, system.turned("acceleration"))].astype(np.int64),
            "lines": np.zeros(LINES * sum(self._widths)),
            **judging,
            "mass": np.ascontiguousarray(system.mass, dtype=float),
            "root_q": np.sqrt(system.mass_by_coordinate),
            "root_u": np.sqrt(system.mass),
        }
        eliminates = system.of_body.dimensions == 3 and self.is_large and self.eliminated.serves
        self.table = packed(
            DYNAMICS,
            {
                "state": self.state.table, "constraining": self._constraining,
                "positions": self._positions.equations_table, "position_factors": self._positions.factors_table,
                "velocities": self._velocities.equations_table, "velocity_factors": self._velocities.factors_table,
                "accelerations": self._accelerations.equations_table, "acceleration_factors": self._accelerations.factors_table,
                **self._lists, "n_trailing": len(self._trailing[1]), "n_algebraic": len(algebraic),
                "n_turned_for_output": len(self._lists["turned_for_output"]),
                "by_reactions": len(algebraic) > 0 or len(system.term("tangent", "rate_lam").row) > 0,
                "switches_by_reactions": system.switches_by_reactions, "eliminates": eliminates, "n_output": self._widths[4], **counts,
                "eliminated": self.eliminated.within_reach() if eliminates else np.zeros(1, dtype=np.int64),
            },
        )  # fmt: skip
        self._at, self._cells = self.table.ctypes.data, self.table.view(DYNAMICS.cells)[0]

    @property
    def status(self) -> int:
        """Return the last failure of output rows or of steps (`stiffmbs.compile.machine.native.statuses`)."""
        return int(self._cells["status"])

    def once(self, make: Callable[[Dynamics, *Settings], T], *settings: *Settings, name: str = "") -> T:
        """Return ``make(self, *settings)``, made again only if the settings or the coordinates have changed.

        `name`: distinguishes several objects made by one function, such as the engines of two solvers.
        """
        key, made_for = name or make, (settings, self.coordinates)
        if key not in self._made or self._made[key][0] != made_for:
            self._made[key] = (made_for, make(self, *settings))
            self.system.known_terms.clear()
        return cast(T, self._made[key][1])

    def forget_pivots(self, within_run: bool = False) -> None:
        """Discard all pivot sequences, so that the rounding of a run does not depend on earlier runs.

        `within_run`: True to keep the largest pivots so far, which show how close a pose is to a singular one.
        """
        for system in (self._positions, self._velocities, self._accelerations):
            system.forget_pivots()
        if "eliminated" in self.__dict__ and not within_run:
            self.eliminated.forget()

    def forget_inputs(self) -> None:
        """Discard the cached features of inputs after formulas of time were changed in place."""
        self.input_changes += 1
        self._features = np.inf, -np.inf, NO_FEATURES
        self._input_end = np.nan, np.nan, None

    def take_input_features(self, other: Dynamics) -> None:
        """Copy the features of inputs from another system if both contain the identical elements with inputs."""
        systems = self.system, other.system
        own, others = ([e for group in s.groups if group.has_inputs for e in group.elements] for s in systems)
        if len(own) == len(others) and all(one is another for one, another in zip(own, others, strict=True)):
            self._features, self._input_end = other._features, other._input_end

    def return_to_start(self) -> None:
        """Reset the state to the described start, with zero multipliers and no relaxation."""
        state, system = self.state, self.system
        state.q[:], state.u[:] = system.q, system.u
        for vector in (state.a, state.lam, state.mu):
            vector[:] = 0.0
        state.relax(state.mu, state.lam)

    def place(self, q: np.ndarray, u: np.ndarray, lam: np.ndarray) -> None:
        """Set the state to a start, independently of how it was found: rounding does not depend on a cache."""
        self.return_to_start()
        self.forget_pivots()
        self.state.q[:], self.state.u[:], self.state.lam[: len(lam)] = q, u, lam

    @cached_property
    def eliminated(self) -> Eliminated:
        """Elimination for accelerations, faster than the LU; explicit steps use it where it serves."""
        from .elimination.eliminated import Eliminated

        return Eliminated(self.state, self.lu_updates)

    @property
    def is_large(self) -> bool:
        """True if output rows and restarts are worth the elimination, which must be compiled."""
        return self.lu_updates > ELIMINATION.worth_compiling

    @property
    def lu_updates(self) -> int:
        """Multiplications of the LU of the block system for accelerations."""
        return self._accelerations.order.updates

    def input_features(self, start: float, end: float) -> InputFeatures:
        """Return the features of the inputs between two times; they are cached for all runs within them."""
        if not self.system.has_inputs:
            return NO_FEATURES
        self._catch_up()
        first, last, found = self._features
        if not first <= start <= end <= last:
            found = input_features(self.system, start, end)
            first, last, found = self._features = start, end, found
        return found if (start, end) == (first, last) else found.within(start, end)

    def follow(self, varied: VariedInput) -> None:
        """Take an input that changes formulas of time, whose elements follow when its features are determined."""
        self._varied = varied

    def meets_no_feature(self, t: float, end: float) -> bool:
        """Return True if a step between two times meets no feature of an input that has changed since its features were determined."""
        return self._varied is not None and self._varied.is_calm(t, end)

    def _catch_up(self) -> None:
        if self._varied:
            self._varied.catch_up()

    def times_around(self, t: float) -> tuple[float, float]:
        """Return the times just before and just after t if an input has a known breakpoint there, else t twice."""
        start, end, found = self._features
        if not len(found.all_breakpoints):
            return t, t
        apart = aside(start, end)
        near = found.all_breakpoints[np.abs(found.all_breakpoints - t) <= 2.0 * apart]
        return (float(near[0]) - apart, float(near[-1]) + apart) if len(near) else (t, t)

    def input_end(self, start: float, end: float) -> InputEnd | None:
        """Return the first end of a formula of time between two times, cached for runs over the same interval."""
        if self.system.has_inputs and self._input_end[:2] != (start, end):
            self._catch_up()
            self._input_end = start, end, first_input_end(self.system, start, end)
        return self._input_end[2]

    def assemble(self, t: float, tolerance: float | None = None, most: int | None = None) -> int:
        """Correct positions by minimum-norm Newton moves until |C| <= tolerance; return their number or a failure."""
        allowed = CONSISTENCY.position_tolerance if tolerance is None else tolerance
        moves = CONSISTENCY.most_assembly_moves if most is None else most
        return ASSEMBLE.short_call(t, allowed, moves, self._at)

    def correct_velocities(self, t: float) -> int:
        """Apply the smallest correction of u in the mass norm with J u + C_t = 0; return 0 or a failure."""
        return CORRECT_VELOCITIES.short_call(t, self._at)

    def accelerate(self, t: float) -> tuple[int, np.ndarray]:
        """Return 0 or a failure (`stiffmbs.compile.machine.native.statuses`), and u'. The multipliers are in `state.lam`."""
        acceleration = np.empty(self.system.n_u)
        return ACCELERATE.short_call(t, address(acceleration), self._at), acceleration

    def position_rates(self, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return q' at a state whose accelerations were just computed; that of an algebraic state is zero."""
        rates = self.system.of_body.position_rates(q, self.system.followed * u)
        self.store_trailing_rates(rates)
        return rates

    def store_trailing_rates(self, rates: np.ndarray) -> None:
        """Store in q' the rates of the coordinates after those of the bodies, where accelerations were just computed."""
        source, row = self._trailing
        if len(row):
            rates[row] = self.state.values["acceleration"][source]

    def trailing_rates(self, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return the rates of the coordinates after those of the bodies at many consistent states, shape (n, n_q - n_pose).

        They are NaN from the first state on that has no accelerations.
        """
        _, row = self._trailing
        rates = np.zeros((len(t), self.system.n_q))
        if len(row):
            found = np.full((len(t), len(row)), np.nan)
            arrays = [np.ascontiguousarray(each, dtype=float) for each in (t, q, u)]
            TRAILING_RATES.call(len(t), *addresses(*arrays, found), self._at)
            rates[:, row] = found
        return rates[:, self.system.n_pose :]

    def report(self, t: np.ndarray, q: np.ndarray, u: np.ndarray, project: bool) -> OutputRows:
        """Return the output rows at given times and states, up to the first that has no solution.

        `t`, `q`, `u` of shapes (n,), (n, n_q), (n, n_u). `project`: True to project each state onto the constraints first.
        """
        count = len(t)
        columns = [allocated(width, count) for width in self._widths]
        done = 0
        for block in blocks(count):
            before = [np.ascontiguousarray(array[block], dtype=float) for array in (t, q, u)]
            written = [column.reshape(-1)[block.start :] for column in columns]
            at_t, at_q, at_u, *at_columns = addresses(*before, *written)
            done = block.start + OUTPUT_POINTS.call(
                len(before[0]), at_t, at_q, at_u, project, CONSISTENCY.position_tolerance, count, *at_columns, self._at
            )
            if count > 1:
                release(*columns, q, u)
            if done < block.stop:
                break
        q, u, acceleration, lam, values = (column[:, :done].T for column in columns[:5])
        judged = dict(zip(JUDGED, columns[5][:, :done], strict=True))
        return OutputRows(t[:done], q, u, acceleration, lam, values, status=self.status, **judged)
