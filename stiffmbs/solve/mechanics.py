"""The mechanics of one system at a state: assembly, projections, accelerations, and what is reported."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..compile.layout import MECHANICS, packed
from ..compile.routines import Routine
from ..compile.state import State
from ..compile.system import System
from .eliminated import Eliminated
from .saddle_point import ACCELERATIONS, POSITION_STEP, VELOCITY_STEP, SaddlePoint

_MODULE = "stiffmbs.solve.native.mechanics"
ASSEMBLE = Routine(_MODULE, "assemble", "int64(float64, float64, int64, int64*)")
CORRECT_VELOCITIES = Routine(_MODULE, "correct_velocities", "int64(float64, int64*)")
ACCELERATE = Routine(_MODULE, "accelerate", "int64(float64, float64*, int64*)")
OUTPUT_POINTS = Routine(
    _MODULE,
    "output_points",
    "int64(int64, float64*, int64, float64, int64, float64*, float64*, float64*, float64*, float64*, float64*, int64*)",
)

POSITION_TOLERANCE = 1e-12
"""Largest violation that a projection onto the positions leaves, in the equations' own units (m, rad), but for rounding."""


@dataclass(frozen=True)
class OutputRows:
    """What is reported at a number of instants, one row each.

    Attributes
    ----------
    t, q, u, acceleration, lam : ndarrays
    values : ndarray
        The values of the output terms (`stiffmbs.compile.terms`).
    position_violation, velocity_violation, drift : ndarrays
        Largest violation of a joint, the norm over its equations, in C and in J u + C_t, and in C before projection.
    status : int
        Why the instant after the last row has no solution (`stiffmbs.solve.failures`); 0 where all have one.
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
    status: int


class Mechanics:
    """Block systems of one state, and the compiled routines that use them.

    Parameters
    ----------
    system : System

    Attributes
    ----------
    state : State
        The current q, u and lam.
    table : ndarray of int
        Addresses for compiled code.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.state = State(system)
        for term_set in ("motion", "output"):
            self.state.load(term_set)
        self._positions = SaddlePoint(POSITION_STEP, self.state)
        self._velocities = SaddlePoint(VELOCITY_STEP, self.state)
        self._accelerations = SaddlePoint(ACCELERATIONS, self.state)
        self._status = np.zeros(1, dtype=np.int64)
        self.table = packed(
            MECHANICS,
            {
                "state": self.state.table,
                "positions": self._positions.equations_table,
                "position_factors": self._positions.factors_table,
                "velocities": self._velocities.equations_table,
                "velocity_factors": self._velocities.factors_table,
                "accelerations": self._accelerations.equations_table,
                "acceleration_factors": self._accelerations.factors_table,
                "status": self._status,
            },
        )

    @cached_property
    def eliminated(self) -> Eliminated:
        """The quicker way to accelerations that explicit steps take where it serves."""
        return Eliminated(self.state)

    @property
    def _at(self) -> int:
        return self.table.ctypes.data

    def assemble(self, t: float, tolerance: float = POSITION_TOLERANCE, most: int = 50) -> int:
        """Move positions by Newton's smallest moves until |C| <= tolerance; the number of moves, or a failure."""
        return ASSEMBLE.load()(t, tolerance, most, self._at)

    def correct_velocities(self, t: float) -> int:
        """The smallest correction of u in the mass matrix that satisfies J u + C_t = 0; 0 or a failure."""
        return CORRECT_VELOCITIES.load()(t, self._at)

    def accelerate(self, t: float) -> tuple[int, np.ndarray]:
        """0 or a failure (`stiffmbs.solve.native.statuses`), and u' from the block system; the multipliers are in the state's lam."""
        acceleration = np.empty(self.system.n_u)
        return ACCELERATE.load()(t, acceleration.ctypes.data, self._at), acceleration

    def report(self, t: np.ndarray, q: np.ndarray, u: np.ndarray, project: bool) -> OutputRows:
        """What is reported at given instants and states, up to the first that has no solution.

        Parameters
        ----------
        t, q, u : ndarrays, shapes (n,), (n, n_q), (n, n_u)
        project : bool
            Whether each state is first brought back to the constraints.
        """
        system, count = self.system, len(t)
        n_output = system.n_values("output")
        t, q, u = (np.array(rows, dtype=float) for rows in (t, q, u))
        acceleration = np.empty((count, system.n_u))
        lam, values = np.empty((count, system.n_c)), np.empty((count, n_output))
        largest = np.empty((count, 3))
        rows = (q, u, acceleration, lam, values, largest)
        addresses = [array.ctypes.data for array in rows]
        tolerance = POSITION_TOLERANCE
        done = OUTPUT_POINTS.load()(count, t.ctypes.data, project, tolerance, n_output, *addresses, self._at)
        q, u, acceleration, lam, values, largest = (array[:done] for array in rows)
        position, velocity, drift = largest.T
        return OutputRows(t[:done], q, u, acceleration, lam, values, position, velocity, drift, int(self._status[0]))
