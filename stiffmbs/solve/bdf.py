"""BDF of variable order and step: SUNDIALS IDA, as Adams' GSTIFF."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np

from ..compile.corners import corner_times
from ..compile.equations import ABSENT, Equations
from ..describe.settings import RunSettings
from ..errors import SolverError
from .engine import Engine, Reached
from .formulations import FORMULATIONS
from .initial import VELOCITIES, InitialValues
from .mechanics import Mechanics
from .native_engine import NativeEngine
from .newton import newton_tolerance
from .relaxation import relax
from .restart import restarted
from .sundae import SundaeEngine
from .sundials.libraries import available
from .sundials.ordering import narrowed
from .tolerances import absolute_tolerances
from .trajectory import Grid, Outcome, Rows, Trajectory, Watch

OUT_OF_THE_ERROR_TEST = 1e15
"""Absolute tolerance of multipliers: huge, so that they count neither in the error test, where index-2 problems would
fail, nor in Newton's convergence test, where IDA's own suppression leaves them (Andrews' mechanism then stops)."""

WORTH_TELLING = 1e-2
"""Change of a velocity at a corner, in parts of the largest, that is told."""
MARGIN = 0.3
"""Part of the tolerance asked for that IDA is given, as the errors of many steps add up (measured with the native
driver's settings: errors below those of IDA's own settings at the full tolerance, in less time)."""


def solve(mechanics: Mechanics, start: InitialValues, grid: Grid, settings: RunSettings, watch: Watch) -> Trajectory:
    """Integrate with IDA; the contract is in `stiffmbs.solve.trajectory`.

    At corners in time, and where a force changes its law (a contact closes), the integrator stops and starts anew.
    """
    integrator = _Integrator(mechanics, settings)
    system = mechanics.system
    rows = Rows(system.n_q, system.n_u, len(grid.times) if grid.times is not None else 1024)
    rows.append(grid.start, start.q, start.u)
    outcome, message = Outcome.DONE, Outcome.DONE.value
    begun = time.perf_counter()
    try:
        for reached in integrator.run(start, grid):
            rows.extend(reached.times, *np.split(reached.rows, [system.n_q], axis=1))
            watch(reached.t)
            if reached.failure:
                outcome, message = Outcome.STOPPED, f"stopped at t = {reached.t:.9g} s: {reached.failure}"
    except SolverError as error:
        outcome, message = Outcome.STOPPED, str(error)
    except KeyboardInterrupt:
        outcome, message = Outcome.INTERRUPTED, Outcome.INTERRUPTED.value
    statistics = {**integrator.statistics(), "seconds": time.perf_counter() - begun}
    return Trajectory(*rows.stored, outcome, message, statistics, integrator.engine.history(), integrator.note)


def _just_after(t: float) -> float:
    """The last instant that IDA cannot tell from t: it refuses to start towards one that is nearer than two roundings."""
    return t + 4 * np.finfo(float).eps * abs(t)


class _Integrator:
    """IDA over the pieces of a run: from corner to corner, from event to event."""

    def __init__(self, mechanics: Mechanics, settings: RunSettings) -> None:
        self.mechanics, self.settings = mechanics, settings
        self.equations = narrowed(Equations(FORMULATIONS[settings.formulation](settings), mechanics.system))
        self.note = ""
        self.engine = self._engine()
        self._events = self._corners = 0

    def _engine(self) -> Engine:
        """The native driver where SUNDIALS' libraries are as it needs them, else scikit-sundae's callbacks."""
        state, longest = self.mechanics.state, self.settings.max_step
        native, reason = available()
        if native:
            return NativeEngine(self.equations, state, *self._tolerances(MARGIN), longest)
        self.note = f"IDA runs through scikit-sundae's callbacks, which is slower: {reason}"
        return SundaeEngine(self.equations, state, *self._tolerances(1.0), longest)

    def _tolerances(self, margin: float) -> tuple[float, np.ndarray]:
        """IDA's tolerances: its norm divides by all unknowns, the tolerance asked for counts those in the error test."""
        at, system = self.equations.at, self.mechanics.system
        tested = self.equations.formulation.tested
        correction = margin * np.sqrt(self.equations.n / sum(len(at[name]) for name in tested))
        atol = np.full(self.equations.n, OUT_OF_THE_ERROR_TEST)
        for name in tested:
            atol[at[name]] = absolute_tolerances(system, self.settings)
        return self.settings.rtol * correction, atol * correction

    def split(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """q and u from a vector of unknowns."""
        return y[self.equations.at["q"]], y[self.equations.at["u"]]

    def run(self, start: InitialValues, grid: Grid) -> Iterator[Reached]:
        """Where the integrator comes at the times of the grid, or after its steps; a failure comes last."""
        t = grid.start
        for stop in (*corner_times(self.mechanics.system, grid.start, grid.end), grid.end):
            while _just_after(t) < stop:
                self._begin(start, t)
                for reached in self._leg(t, stop, grid):
                    yield reached
                if reached.failure:
                    return
                t = reached.t
                if t < grid.end:
                    q, u = self.split(reached.y)
                    start = restarted(self.mechanics, t, q, u)
                    self._tell_jump(t, start.u - u)
                    yield self._at_once(start, t, grid)
                    self._events += t < stop
                    self._corners += t >= stop

    def _tell_jump(self, t: float, change: np.ndarray) -> None:
        """Note a change of velocities at a corner that no error of the integrator explains: a drive jumped."""
        k = int(np.argmax(np.abs(change)))
        if abs(change[k]) > WORTH_TELLING * max(1.0, float(np.max(np.abs(self.mechanics.state.u)))):
            name = f"{self.mechanics.system.bodies[k // 3]}.{VELOCITIES[k % 3]}"
            self.note = (
                f"at t = {t:.6g} s a drive makes velocities jump ({name} by {change[k]:.3g}); no force shows that blow"
            )

    def _leg(self, t: float, stop: float, grid: Grid) -> Iterator[Reached]:
        """Integrate from t to `stop` or to the first event."""
        if grid.times is None:
            return self.engine.by_steps(stop)
        return self.engine.to_times(grid.times[(grid.times > _just_after(t)) & (grid.times <= stop)], stop)

    @staticmethod
    def _at_once(start: InitialValues, t: float, grid: Grid) -> Reached:
        """Output times that rounding alone keeps from t, as 0.1 s * 7 from a corner at 0.7 s: the state at t is theirs."""
        state = np.concatenate([start.q, start.u])
        times = np.empty(0) if grid.times is None else grid.times[(grid.times > t) & (grid.times <= _just_after(t))]
        return Reached(times, np.tile(state, (len(times), 1)), t, state)

    def _begin(self, start: InitialValues, t: float) -> None:
        at = self.equations.at
        y, yp = np.zeros(self.equations.n), np.zeros(self.equations.n)
        y[at["q"]], y[at["u"]] = start.q, start.u
        yp[at["q"]], yp[at["u"]] = start.u, start.acceleration
        solved = at["lam"] != ABSENT
        multipliers = yp if self.equations.formulation.integrated else y
        multipliers[at["lam"][solved]] = start.lam[solved]
        relax(self.mechanics, self.settings, t)
        self.engine.begin(t, y, yp, newton_tolerance(self.mechanics, self.settings, t))

    def statistics(self) -> dict[str, int | float]:
        """IDA's counters, and how often it started anew."""
        return {**self.engine.statistics(), "corners": self._corners, "events": self._events}
