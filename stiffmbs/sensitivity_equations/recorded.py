"""Recorded run of `bdf` or `radau`: all steps, in segments between restarts at breakpoints and events."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from ..compile.directional.direction import Direction
from ..compile.equations import ABSENT
from ..compile.law_intervals import intervals_of
from ..compile.state import State
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import ChatteringError, SolverError
from ..model.settings import RunSettings
from ..solve.engine import Reached
from ..solve.events.native.parameters import INDISTINCT
from ..solve.ida.choice import driven
from ..solve.ida.native_engine import NativeEngine
from ..solve.integrator import Integrator
from ..solve.radau.collocation import radau
from ..solve.radau.radau import CONTROL, driven_by_radau
from ..solve.trajectory import Grid
from ..tuning import tuned

STAGES: Final = 5
"""Stages of the method by which sensitivities are integrated along steps of `radau`."""


@dataclass(frozen=True)
class SensitivityParameters:
    """Parameters of recorded runs, of jumps of sensitivities, and of events that sensitivities refuse.

    Source: tests/studies.
    """

    rounding: float = 1e-13
    """Rounding of times, relative to the time: least shift of a segment's end before an event, duration of an empty segment."""
    furthest: float = 1e-6
    """Largest shift of a segment's end before an event, relative to the segment."""
    short: float = 0.1
    """Size of a step, relative to the median of a segment, below which it may contain a discontinuity, as errors there
    shorten steps."""
    sudden: float = 10.0
    """Change of an acceleration in a step, relative to that expected from the steps around it, that may be a discontinuity."""
    jump: float = 1e-3
    """Smallest discontinuity of an acceleration, relative to its largest value."""
    felt: float = 1e-6
    """Smallest discontinuity of an acceleration, relative to all accelerations."""
    halvings: int = 10
    """Halvings of the displacement in a step, in search of a discontinuity."""
    left: float = 0.5
    """Part of a change that a discontinuity leaves in the last interval."""
    roundings: float = 1e3
    """Least size of a discontinuity relative to the effect of rounding of the state."""
    most_numbers: int = 200_000_000
    """Largest number of recorded numbers, 1.6 GB."""
    no_jump: float = 100.0
    """Largest difference of rates on both sides of an event that does not count as a jump, in relative tolerances."""
    much_larger: float = 2.0
    """Largest ratio of position sensitivities at a moving to those at a fixed time for which the former are used."""
    alike: float = 1e-6
    """Smallest relative difference of event time derivatives of separate events, and smallest relevant effect of a jump."""
    grazing: float = 1e-9
    """Rate of an event function that counts as zero, relative to its change in the segment over the duration."""
    near: float = 1e-3
    """Largest extremum near zero, relative to the largest value of an event function in a segment: the largest rtol."""
    further: float = 1e3
    """Ratio of two displacements from a grazed breakpoint."""
    linear: float = 0.1
    """Ratio of the rate changes over these displacements that indicates a jump."""
    at_rest: float = 1e-12
    """Value, SI units, of an event function that is on its breakpoint."""
    moved: float = 1e-6
    """Displacement from a state on a breakpoint, m or rad."""
    kinked: float = 0.4
    """Second difference of rates over half of it, relative to that over the whole, which is 1/2 at a kink and 1/4 without."""
    noticed: float = 1e-12
    """Least second difference, relative to the rates."""
    steady: float = 0.75
    """Least ratio of the errors of derivatives over half of a displacement and the whole: 1 at a breakpoint, 1/2 at most
    without one."""
    rounded: float = 1e-14
    """Rounding of forces, relative to the largest one, and of places, relative to the largest coordinate."""


SENSITIVITIES = tuned("sensitivities", SensitivityParameters())


@dataclass
class Segment:
    """Steps between two restarts.

    - `first` of shape (2 + 2 n,): time, order, y and y' at the start.
    - `rows` of shape (steps, 2 + 2 n): the same at the end of each step.
    - `steps` of shape (steps, 1 + places, 2 + 2 n): the same with rows at places within the step, without y', before
      its end.
    - `places`: number of places within a step.
    - `fired`: event functions that end it; empty at a breakpoint in time or the end of the run.
    """

    start: InitialValues
    first: np.ndarray
    parts: list[np.ndarray] = field(default_factory=list)
    fired: tuple[int, ...] = ()
    places: int = 0

    @property
    def steps(self) -> np.ndarray:
        """Rows of all steps; see the class."""
        if len(self.parts) > 1:
            self.parts = [np.concatenate(self.parts)]
        rows = self.parts[0] if self.parts else np.empty((0, len(self.first)))
        return rows.reshape(-1, 1 + self.places, len(self.first))

    @property
    def rows(self) -> np.ndarray:
        """Rows at the ends of all steps, shape (steps, 2 + 2 n); see the class."""
        rows: np.ndarray = self.steps[:, -1]
        return rows


class Recorder(Integrator[NativeEngine]):
    """Integrator that records its steps, which end at kinks of tables, as force derivatives are discontinuous there.

    Steps of `radau` are recorded at the nodes of its method of `STAGES` stages too. After a run that stopped because a
    force chatters, `chatters` is True.
    """

    def __init__(self, dynamics: Dynamics, settings: RunSettings) -> None:
        self.nodes = radau(STAGES).nodes[:-1] if settings.solver == "radau" else np.empty(0)
        of_radau = CONTROL, "radau recorder", driven_by_radau
        made = driven(dynamics, settings, *(of_radau if len(self.nodes) else (None, "recorder")))
        super().__init__(dynamics, settings, made.engine)
        self.equations = self.engine.equations
        self.engine.watch.end_steps_at_kinks()
        self.segments: list[Segment] = []
        self.chatters = False
        self._numbers = 0

    @property
    def longest_step(self) -> float:
        """Length of the longest step, s."""
        times = (np.append(each.first[0], each.rows[:, 0]) for each in self.segments)
        return max((float(np.diff(t).max(initial=0.0)) for t in times), default=0.0)

    def passed(self, duration: float) -> list[Segment]:
        """Return the segments of nonzero length; raise a SolverError when accelerations are discontinuous within one."""
        found = [each for each in self.segments if len(each.rows)]
        found = [
            each for each in found if each.rows[-1, 0] - each.first[0] > SENSITIVITIES.rounding * duration
        ] or found
        for segment in found:
            self._refuse_jumps_within(segment)
        return found

    def _refuse_jumps_within(self, segment: Segment) -> None:
        """Refuse forces with undeclared discontinuities, where an acceleration changes more than around a step."""
        rows, n, at = segment.rows, self.equations.n, self.equations.at["u"]
        h = np.diff(rows[:, 0])[:, None]
        short = h[:, 0] < SENSITIVITIES.short * np.median(h) if len(h) else np.zeros(0, dtype=bool)
        if not short.any():
            return
        near = np.convolve(np.append(short, False), np.ones(4), "full")[1 : 1 + len(rows)] > 0
        a = np.full((len(rows), len(at)), np.nan)
        a[near] = self._all_accelerations(rows[near])
        system, largest = self.dynamics.system, np.abs(rows[:, 2 + n + at]).max(axis=0)
        scale = system.per_velocity(system.size, 1.0)
        least = np.maximum(SENSITIVITIES.jump * largest, SENSITIVITIES.felt * np.max(largest / scale) * scale)
        change = np.abs(np.diff(a, axis=0))
        slopes = np.pad(change / h, ((1, 1), (0, 0)))
        expected = h * np.nan_to_num(np.fmax(slopes[:-2], slopes[2:]))
        sudden = np.any((change > least) & (change > SENSITIVITIES.sudden * expected), axis=1)
        for k in np.flatnonzero(short & sudden):
            if self._jumps_between(rows[k], rows[k + 1], least):
                raise SolverError(
                    f"sensitivities: found that accelerations are discontinuous at t = {rows[k, 0]:.9g} s, where no force declares a breakpoint (a spring "
                    "that passes its anchor, a discontinuous Python function): the motion is not differentiable there; expected "
                    "continuous forces"
                )

    def _jumps_between(self, before: np.ndarray, after: np.ndarray, least: np.ndarray) -> bool:
        """Return True if the change of accelerations between two states is in a small part of the way between them."""
        n = self.equations.n
        ends = [(row[: 2 + n], self._accelerations(row[0], row[2 : 2 + n])) for row in (before, after)]
        changed = ends[1][1]
        whole = np.abs(changed - ends[0][1])
        for _ in range(SENSITIVITIES.halvings):
            middle = (ends[0][0] + ends[1][0]) / 2
            found = middle, self._accelerations(middle[0], middle[2:])
            changes = [np.max(np.abs(found[1] - end) / np.maximum(whole, least)) for _, end in ends]
            ends[int(np.argmin(changes))] = found
        left = np.abs(ends[1][1] - ends[0][1])
        noise = self._accelerations(after[0], after[2 : 2 + n] * (1 + np.finfo(float).eps)) - changed
        return bool(
            np.any(
                (left > least) & (left > SENSITIVITIES.left * whole) & (left > SENSITIVITIES.roundings * np.abs(noise))
            )
        )

    def _all_accelerations(self, rows: np.ndarray) -> np.ndarray:
        """Return the accelerations of the force law at recorded states, NaN where there are none."""
        y = rows[:, 2 : 2 + self.equations.n]
        q, u = self.equations.states(np.ascontiguousarray(y[:, self.equations.independent]))
        found = self.dynamics.report(np.ascontiguousarray(rows[:, 0]), q, u, False).acceleration
        return np.pad(found, ((0, len(rows) - len(found)), (0, 0)), constant_values=np.nan)

    def _accelerations(self, t: float, y: np.ndarray) -> np.ndarray:
        """Return the accelerations at a state."""
        self.dynamics.state.q[:], self.dynamics.state.u[:] = self.engine.split(y)
        return self.dynamics.accelerate(t)[1].copy()

    def _started(self) -> None:
        state = self.dynamics.state
        values = state.q.copy(), state.u.copy(), state.a.copy(), state.lam.copy()
        if self.segments:
            self._end_before_the_jump(self.segments[-1])
        start = InitialValues(*values, (), self.dynamics.system.size)
        self.segments.append(Segment(start, self.engine.present(), places=len(self.nodes)))

    def _end_before_the_jump(self, segment: Segment) -> None:
        """Move the end of a segment back by some roundings of time, to where its force law holds."""
        rows, n = segment.rows, self.equations.n
        if not len(rows):
            return
        t, y, yp = rows[-1, 0], rows[-1, 2 : 2 + n].copy(), rows[-1, 2 + n :]
        back = SENSITIVITIES.rounding * max(abs(t), t - segment.first[0])
        furthest = SENSITIVITIES.furthest * (t - segment.first[0])
        if back < furthest and self.dynamics.system.n_values("event_function"):
            within = self._sides(segment, t - furthest, y - furthest * yp)
            while back < furthest and self._sides(segment, t - back, y - back * yp) != within:
                back *= 10.0
        rows[-1, 0] = t - back
        rows[-1, 2 : 2 + n] = y - back * yp

    def take(self, y: np.ndarray, into: State | Direction) -> None:
        """Copy a recorded y, or its change, into a state or a direction: coordinates, velocities and solved multipliers."""
        lam = self.equations.at["lam"]
        solved = lam != ABSENT
        into.q[:], into.u[:] = self.engine.split(y)
        into.lam[solved] = y[lam[solved]]

    def _sides(self, segment: Segment, t: float, y: np.ndarray) -> list[int]:
        """Return the sides of the event that ends a segment, and the intervals of tables with kinks, at a state."""
        state = self.dynamics.state
        with state.unchanged():
            self.take(y, state)
            state.evaluate("event_function", t)
            values = state.values["event_function"]
            events = [int(values[event] > 0.0) for event in segment.fired[:1]]
            return events + intervals_of(self.dynamics.system).of_kinked(values)

    def run(self, start: InitialValues, grid: Grid, passing: bool = False) -> Iterator[Reached]:
        """Yield the progress as any integrator, stopping at each breakpoint; the steps are in `segments` afterwards."""
        self.engine.ida.keep_steps(True, self.nodes)
        try:
            for reached in super().run(start, grid):
                self._keep(reached)
                yield reached
        except ChatteringError:
            self.chatters = True
            raise
        finally:
            self.engine.ida.keep_steps(False)

    def _keep(self, reached: Reached) -> None:
        rows = self.engine.ida.kept_steps()
        if not len(rows):
            return
        segment = self.segments[-1]
        last = segment.parts[-1][-1, 0] if segment.parts else segment.first[0]
        steps = rows.reshape(-1, 1 + len(self.nodes), rows.shape[1])
        ends = steps[:, -1, 0]
        kept = np.diff(ends, prepend=last) > INDISTINCT * np.abs(ends)
        segment.parts.append(steps[kept].reshape(-1, rows.shape[1]))
        segment.fired = reached.fired
        self._numbers += rows.size
        if self._numbers > SENSITIVITIES.most_numbers:
            raise SolverError(
                f"sensitivities: found {self._numbers / rows.shape[1]:.3g} steps of {rows.shape[1]} numbers, expected fewer; "
                "give a shorter duration or a larger rtol"
            )
