"""Start or restart of IDA from consistent values by one compiled call."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....compile.equations import ABSENT, Equations
from ....compile.machine.layout import packed
from ....compile.machine.object_code import SHORT
from ....compile.machine.routines import together
from ....compile.state import SETS
from ....dynamics.dynamics import Dynamics
from ....model.settings import RunSettings
from ...error_control.error_test import ErrorControl
from ...error_control.native.parameters import NEWTON
from ...error_control.newton import RowSums, Stiffness, row_sums_of
from ...error_control.relaxation import drift_of_positions, drift_of_velocities, inverse_mass
from ..native.layouts import START
from ..statistics import Statistics, failure_sentence

if TYPE_CHECKING:
    from ....dynamics.initial import InitialValues
    from ..ida import NativeIda

_START, _RESUME = together(
    "stiffmbs.solve.ida.starting.native.start",
    SHORT,
    start="int32(float64, int64, int64, int64*)",
    resume="int32(float64, int64, int64*)",
)
FUNCTIONS = {
    "set_newton": "IDASetNonlinConvCoef", "reinitialise": "IDAReInit", "set_first_step": "IDASetInitStep",
    "set_growth": "IDASetEtaFixedStepBounds", "set_highest_order": "IDASetMaxOrd",
}  # fmt: skip
OF_STIFFNESS = "of_positions", "of_velocities"
"""Cells of the fields of a `Stiffness`."""


class Starts:
    """Compiled starts of one integrator.

    `ida`: driver of IDA. `statistics`: counters of IDA. `table`: table for compiled code
    (`stiffmbs.solve.ida.native.layouts.START`).
    """

    def __init__(
        self, dynamics: Dynamics, equations: Equations, ida: NativeIda, statistics: Statistics,
        settings: RunSettings, control: ErrorControl,
    ) -> None:  # fmt: skip
        system, self._state = dynamics.system, dynamics.state
        for term_set in ("motion", "tangent"):
            self._state.load(term_set)
        values: dict[str, Any] = {
            "dynamics": dynamics.table, "ida": ida.table, "error_norm": ida.error_norm.table, "n_watched": ida.watch.n,
            "rate": np.zeros(system.n_q), "kept": np.zeros(system.n_q + system.n_u + system.n_c), "sums": np.zeros(system.n_u),
            **_places(equations), **_relaxing(dynamics, settings, control.relaxation), **_stiff(dynamics), **statistics.arrays,
            **newton_bounds(settings.rtol, control.newton), "growth": control.growth,
            **{name: ida.address(function) for name, function in FUNCTIONS.items()},
        }  # fmt: skip
        self._kept = values, ida
        self.table = packed(START, values)
        self._cells, self._at = self.table.view(START.cells)[0], self.table.ctypes.data

    def begin(self, start: InitialValues, t: float, counted: bool, highest_order: int) -> None:
        """Start at consistent values.

        `t`: s. `counted`: true if IDA's counters belong to this run. Raises ValueError if IDA reports an error.
        """
        state = self._state
        state.q[:], state.u[:], state.a[:], state.lam[:] = start.q, start.u, start.acceleration, start.lam
        _sound(_START.short_call(t, counted, highest_order, self._at))

    def resume(self, newton: float, highest_order: int) -> None:
        """Start at IDA's current unknowns, with a part of the tolerance that Newton's iteration may leave."""
        _sound(_RESUME.short_call(newton, highest_order, self._at))

    def found(self) -> tuple[Stiffness, float]:
        """Return the stiffness at the last start, and the part of the tolerance that Newton's iteration may leave."""
        cells = self._cells
        return Stiffness(*(float(cells[name]) for name in OF_STIFFNESS)), float(cells["newton"])


def _sound(flag: int) -> None:
    if flag < 0:
        raise ValueError(failure_sentence(flag))


def newton_bounds(rtol: float, fixed: float | None) -> dict[str, float]:
    """Return the product of Newton's tolerance and the stiffness, and its bounds: the fixed one of the integrator, if any."""
    tightest = max(NEWTON.negligible, NEWTON.precision / rtol)
    return {"soft": NEWTON.soft, "loosest": fixed or NEWTON.loosest, "tightest": fixed or tightest}


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
