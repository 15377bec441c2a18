"""IDA started anew at one instant after the other, as inputs jump: one compiled call for each."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...compile.equations import ABSENT, Equations
from ...compile.machine.layout import packed
from ...compile.machine.routines import Routine
from ...compile.system import System
from ...describe.settings import RunSettings
from ..dynamics import Dynamics
from ..error_control.error_test import ErrorControl
from ..error_control.newton import LOOSEST, NUMBERS_END, SOFT, TIGHTEST
from ..error_control.relaxation import creep_of_positions, creep_of_velocities, lightness
from ..native.tables.steps import RESTART
from .connection import Connection

_RESTART = Routine("stiffmbs.solve.ida.native.restart", "restart", "int32(float64, float64, int64*)")
FUNCTIONS = {
    "set_newton": "IDASetNonlinConvCoef", "start_anew": "IDAReInit", "set_first_step": "IDASetInitStep",
    "set_growth": "IDASetEtaFixedStepBounds",
}  # fmt: skip


class Restarts:
    """The present state, and a way to later ones that forgets what was behind it.

    Parameters
    ----------
    dynamics : Dynamics
    present : tuple of ndarrays, shapes (n_q,), (n_u,)
        Memory of the present q and u, which `advance` starts from and writes.
    equations : Equations
    connection : Connection
        To IDA.
    settings : RunSettings
    control : ErrorControl

    Attributes
    ----------
    table : ndarray of int
        For compiled code (`stiffmbs.solve.native.tables.steps.RESTART`).
    """

    def __init__(
        self, dynamics: Dynamics, present: tuple[np.ndarray, np.ndarray], equations: Equations, connection: Connection,
        settings: RunSettings, control: ErrorControl,
    ) -> None:  # fmt: skip
        system, state = dynamics.system, dynamics.state
        q, u = present
        for term_set in ("motion", "tangent"):
            state.load(term_set)
        floats = {
            "q": q, "u": u, "rate": np.zeros(system.n_q), "sums": np.zeros(system.n_u),
            "creep": np.zeros(2 * system.n_c), "mass": np.ascontiguousarray(system.mass),
        }  # fmt: skip
        values: dict[str, Any] = {
            "dynamics": dynamics.table, "ida": connection.table, "error_norm": connection.error_norm.table,
            **floats, **_places(equations), **_creeping(dynamics, equations, settings), **_stiff(system),
            "soft": SOFT, "loosest": control.newton or LOOSEST,
            "tightest": control.newton or max(TIGHTEST, NUMBERS_END / settings.rtol), "growth": control.growth,
            **{name: connection.address(function) for name, function in FUNCTIONS.items()},
        }  # fmt: skip
        self._kept = values, connection
        self.table = packed(RESTART, values)
        self._call, self._at = _RESTART.call, self.table.ctypes.data

    @staticmethod
    def serve(system: System, connection: Connection) -> bool:
        """Whether a compiled start does all that one needs: no event functions to look at, no algebraic states or turns to be counted
        anew, no threads of a linear solver to hold back."""
        counted = system.n_event_functions or system.n_counters or len(system.algebraic_coordinates)
        return not counted and connection.on_one_thread

    def advance(self, t: float, end: float) -> bool:
        """Go on from the state at t, s, made consistent, to a later time; False, with the state as it was, where that takes a run."""
        done: bool = self._call(t, end, self._at) == 0
        return done


def _places(equations: Equations) -> dict[str, Any]:
    """Which coordinates and velocities are unknowns, and where they stand."""
    coordinates = equations.coordinates
    found: dict[str, Any] = {"leader": _integers(coordinates.independent_of)}
    for name, independent in (("q", coordinates.independent), ("u", coordinates.independent_u)):
        numbers = np.flatnonzero(independent & (equations.at[name] != ABSENT))
        found |= {
            f"n_{name}": len(numbers),
            f"{name}_of": numbers,
            f"{name}_at": _integers(equations.at[name][numbers]),
        }
    return found


def _creeping(dynamics: Dynamics, equations: Equations, settings: RunSettings) -> dict[str, Any]:
    """The entries that relaxations follow from, and where these stand among the values."""
    system, formulation = dynamics.system, equations.formulation
    positions, velocities = system.term("motion", "C_q"), system.term("motion", "J")
    weight = np.empty(0)
    if system.n_c:
        weight = creep_of_velocities(settings, system) * lightness(dynamics)[velocities.column]
    return {
        "n_position_entries": len(positions.row), "position_source": _integers(positions.source), "position_row": _integers(positions.row),
        "position_creep": creep_of_positions(settings),
        "n_velocity_entries": len(velocities.row), "velocity_source": _integers(velocities.source), "velocity_row": _integers(velocities.row),
        "velocity_weight": np.ascontiguousarray(weight),
        "at_residual": system.constants(formulation.residual_set)["E_mu"], "at_matrix": system.constants(formulation.matrix_set)["E_mu"],
    }  # fmt: skip


def _stiff(system: System) -> dict[str, Any]:
    """The entries of the derivatives of forces."""
    found: dict[str, Any] = {}
    for name in ("f_q", "f_u"):
        term = system.term("tangent", name)
        found |= {f"n_{name}": len(term.row), f"{name}_source": _integers(term.source), f"{name}_row": _integers(term.row)}  # fmt: skip
    return found


def _integers(numbers: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(numbers, dtype=np.int64)
