"""Start of IDA from consistent values, or after an event or breakpoint, by one compiled call."""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ...compile.equations import ABSENT, Equations
from ...compile.machine.layout import DTYPES, fill, packed
from ...compile.machine.object_code import SHORT
from ...compile.machine.routines import Routine, together
from ...compile.state import SETS
from ...dynamics.dynamics import Dynamics
from ...model.settings import RunSettings
from ..engine import Begun
from ..error_control.error_test import ErrorControl
from ..error_control.native.parameters import NEWTON, POLISHING
from ..error_control.newton import RowSums, row_sums_of
from ..error_control.relaxation import drift_of_positions, drift_of_velocities, inverse_mass
from ..events.discontinuity import JUMP, VELOCITY_JUMP, Jumps, direction_of
from .native.layouts import START
from .statistics import failure_sentence

if TYPE_CHECKING:
    from ...dynamics.initial import InitialValues
    from ..stiff_rows import States
    from .ida import NativeIda

START_MODULE, RESTART_MODULE = (f"stiffmbs.solve.ida.native.{name}" for name in ("start", "breakpoints"))
_START, _RESUME = together(
    START_MODULE, SHORT, start="int32(float64, int64, int64, int64*)", resume="int32(float64, int64, int64*)"
)
RESTARTED = Routine(
    RESTART_MODULE, "restarted_at_event", "int32(float64, float64, float64, int64, int64, int64*)", level=SHORT
)
ADVANCE = Routine(RESTART_MODULE, "advance_from", "int32(float64, float64, int64, int64*)")
FUNCTIONS = {
    "set_newton": "IDASetNonlinConvCoef", "reinitialise": "IDAReInit", "set_first_step": "IDASetInitStep",
    "set_growth": "IDASetEtaFixedStepBounds", "set_highest_order": "IDASetMaxOrd",
}  # fmt: skip
UNUSED = dict.fromkeys(START, 0) | {
    name: np.empty(0, dtype=DTYPES[START[name]]) for name in START if START[name] in DTYPES
}
"""Contents of columns that only restarts use, before the first of them."""


class Starts:
    """Compiled starts of one integrator.

    `ida`: driver of IDA. `may_pass`: true if one call may pass several breakpoints: no event
    functions, and no forces that depend on multipliers. `may_stiffen`: true if forces depend on positions or velocities.
    """

    def __init__(
        self, dynamics: Dynamics, equations: Equations, ida: NativeIda, settings: RunSettings, control: ErrorControl
    ) -> None:
        system, self._state = dynamics.system, dynamics.state
        for term_set in ("motion", "tangent"):
            self._state.load(term_set)
        self._of_restarts = partial(_restarting, dynamics, settings)
        values: dict[str, Any] = {
            "dynamics": dynamics.table, "ida": ida.table, "error_norm": ida.error_norm.table, "n_watched": ida.watch.n,
            "rate": np.zeros(system.n_q), "kept": np.zeros(system.n_q + 2 * (system.n_u + system.n_c)), "sums": np.zeros(system.n_u),
            **_places(equations), **_relaxing(dynamics, settings, control.relaxation), **_stiff(dynamics), **ida.counters.arrays,
            **newton_bounds(settings.rtol, control.newton), **polishing_bounds(settings.rtol), "growth": control.growth,
            **{name: ida.address(function) for name, function in FUNCTIONS.items()},
        }  # fmt: skip
        self._values, self._ida, self._table = values, ida, packed(START, {**UNUSED, **values})
        self._cells, self._at = self._table.view(START.cells)[0], self._table.ctypes.data
        ida.cells["starts"] = self._at
        self.may_stiffen = values["n_f_q"] + values["n_f_u"] > 0
        self._has_events = system.n_event_functions > 0
        self.may_pass = not self._has_events and not len(system.term("acceleration", "f_lam").row)

    def begin(self, start: InitialValues, t: float, highest_order: int) -> None:
        """Start at consistent values and a time, s. Raises ValueError if IDA reports an error."""
        state = self._state
        state.q[:], state.u[:], state.a[:], state.lam[:] = start.q, start.u, start.acceleration, start.lam
        _sound(_START.short_call(t, self._ida.begun, highest_order, self._at))

    def resume(self, newton: float, highest_order: int) -> None:
        """Start at IDA's current unknowns, with a part of the tolerance that Newton's iteration may leave."""
        _sound(_RESUME.short_call(newton, highest_order, self._at))

    @cached_property
    def table(self) -> int:
        """Address of the memory of compiled code for restarts, which is made at the first one."""
        for term_set in ("position", "event_function"):
            self._state.load(term_set)
        self._values |= self._of_restarts()
        fill(self._table, self._values)
        return self._at

    def restart(self, state: States, t: float, ahead: float, stop: float, highest_order: int) -> Begun | None:
        """Restart at consistent values after a state.

        `state`: q and u. `t`: s. `ahead`: least time of extrapolation past events simultaneous with
        the one at t, s; 0 for none. `stop`: next time at which IDA stops, s. Returns None, without a start, if there are no consistent values or a
        force is beyond its limits.
        """
        self._state.q[:], self._state.u[:] = state
        if RESTARTED.short_call(t, ahead, stop, self._ida.begun, highest_order, self.table) < 0:
            return None
        cells = self._cells
        return Begun(float(cells["t"]), bool(cells["jumps"]), bool(cells["meets"]))

    def advance(self, state: States, t: float, end: float, highest_order: int) -> bool:
        """Integrate a state, which is overwritten, to a later time; False, with the state unchanged, if it needs a run."""
        if self._has_events:
            return False
        (q, u), own = state, self._state
        own.q[:], own.u[:] = q, u
        if ADVANCE.call(t, end, highest_order, self.table) != 0:
            return False
        q[:], u[:] = own.q, own.u
        return True

    def resume_after(self, gap: float) -> None:
        """Set the time from a breakpoint to the restart after it, s."""
        self._cells["gap"] = gap

    @property
    def t(self) -> float:
        """Return the time of the last start, s."""
        return float(self._cells["t"])

    @property
    def passed(self) -> tuple[int, int]:
        """Return the number of breakpoints passed by the last call, and its steps before the last of them."""
        return int(self._cells["passed"]), int(self._cells["steps_before"])

    @property
    def newton(self) -> float:
        """Return the part of the tolerance that Newton's iteration may leave."""
        return float(self._cells["newton"])


def _sound(flag: int) -> None:
    if flag < 0:
        raise ValueError(failure_sentence(flag))


def newton_bounds(rtol: float, fixed: float | None) -> dict[str, float]:
    """Return the product of Newton's tolerance and the stiffness, and its bounds: the fixed one of the integrator, if any."""
    tightest = max(NEWTON.negligible, NEWTON.precision / rtol)
    return {"soft": NEWTON.soft, "loosest": fixed or NEWTON.loosest, "tightest": fixed or tightest}


def polishing_bounds(rtol: float) -> dict[str, float]:
    """Return the factor of long steps, and the least residual and the imbalance that corrections within them may leave."""
    return {"amplified": POLISHING.amplified, "least": NEWTON.precision / rtol, "balanced": POLISHING.unbalanced * rtol}


def _places(equations: Equations) -> dict[str, Any]:
    """Return the coordinates and velocities that are unknowns, and their positions in the vector."""
    coordinates = equations.coordinates
    found: dict[str, Any] = {"leader": integers(coordinates.independent_of)}
    for name, independent in (("q", coordinates.independent), ("u", coordinates.independent_u)):
        numbers = np.flatnonzero(independent & (equations.at[name] != ABSENT))
        found |= {f"n_{name}": len(numbers), f"{name}_of": numbers, f"{name}_at": integers(equations.at[name][numbers])}
    return found


def _relaxing(dynamics: Dynamics, settings: RunSettings, factor: float) -> dict[str, Any]:
    """Return the entries that determine relaxations, and the positions of relaxations in each term set."""
    system = dynamics.system
    positions, velocities = system.term("motion", "C_q"), system.term("motion", "J")
    return {
        "relaxations": dynamics.state.relaxations,
        "n_position_entries": len(positions.row), "position_source": integers(positions.source), "position_row": integers(positions.row),
        "position_drift": factor * drift_of_positions(settings),
        "n_velocity_entries": len(velocities.row), "velocity_source": integers(velocities.source), "velocity_row": integers(velocities.row),
        "velocity_drift": factor * drift_of_velocities(settings, system),
        "inverse_mass": np.ascontiguousarray(inverse_mass(dynamics)[velocities.column]) if system.n_c else np.empty(0),
        "n_sets": len(SETS), "at_relaxations": integers(np.array([system.constants(term_set)["E_mu"] for term_set in SETS])),
    }  # fmt: skip


def _restarting(dynamics: Dynamics, settings: RunSettings) -> dict[str, Any]:
    """Return what restarts need: event functions, revolution counters, sizes of jumps, and memory."""
    system, (speed, least_jump) = dynamics.system, Jumps(dynamics, settings).resolution
    counted, n = system.term("position", "continuous_angle"), system.n_event_functions
    along_q, along_u = direction_of(dynamics)
    return {
        "n_event_functions": n, "first_limit": system.first_limit,
        "n_counters_of_angles": len(counted.row), "angle_source": integers(counted.source), "angle_row": integers(counted.row),
        "reach": JUMP.larger_move, "along_q": along_q, "along_u": along_u,
        "largest_jump": VELOCITY_JUMP.least, "least_jump": least_jump, "speed": speed,
        "q": np.empty(system.n_q), "u": np.empty(system.n_u), "values": np.empty(n), "found": np.empty(n, dtype=np.int64),
    }  # fmt: skip


def _stiff(dynamics: Dynamics) -> dict[str, Any]:

    def of(name: str, sums: RowSums) -> dict[str, Any]:
        return {
            f"n_{name}": len(sums.row), f"{name}_source": integers(sums.source), f"{name}_row": integers(sums.row),
            f"{name}_scale": np.ascontiguousarray(sums.scales),
        }  # fmt: skip

    of_positions, of_velocities = row_sums_of(dynamics)
    return {**of("f_q", of_positions), **of("f_u", of_velocities)}


def integers(numbers: np.ndarray) -> np.ndarray:
    """Return indices for compiled code."""
    return np.ascontiguousarray(numbers, dtype=np.int64)
