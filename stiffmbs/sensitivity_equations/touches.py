"""Grazing events, at which the motion is not differentiable: detected in recorded steps, within the integration error.

If the minimum of g is -d, a force that is discontinuous at g = 0 acts for a time proportional to sqrt(d/g''). If it is
+d, the force does not act. The derivative by d is unbounded, and below the integration error d is undetermined.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..compile.directional.direction import Direction, unchanged
from ..compile.directional.source import STATE
from ..compile.equations import ABSENT
from ..compile.written_values import writer
from ..errors import SolverError
from ..solve.error_control.tolerances import independent_tolerances
from .recorded import Recorder, Segment

NEAR = 1e-3
"""Largest extremum near zero, relative to the largest value of an event function in a segment: the largest rtol."""
FURTHER, LINEAR = 1e3, 0.1
"""Ratio of two displacements from a grazed breakpoint, and ratio of rate changes that indicates a jump."""


class Touches:
    """Detector of grazing events in a recorded run."""

    def __init__(self, recorder: Recorder) -> None:
        self._recorder, self._dynamics = recorder, recorder.dynamics
        self._count = self._dynamics.system.n_event_functions
        self._atol = np.zeros(recorder.equations.n)
        self._atol[recorder.equations.independent] = independent_tolerances(recorder.equations, recorder.settings)
        self._by_time = Direction(self._dynamics.state, "event_function", unchanged(self._dynamics.system), STATE)

    def refuse(self, segments: Sequence[Segment]) -> None:
        """Raise a SolverError if a discontinuous force almost reaches, or barely crosses, its breakpoint."""
        if not self._count:
            return
        rows = np.concatenate([part for each in segments for part in (each.first[None], each.rows)])
        found = np.array([self._values(row) for row in rows])
        g, rates = found[:, 0], found[:, 1]
        steps = np.diff(rows[:, 0])
        turns = (rates[:-1] * rates[1:] < 0) & (steps > 0)[:, None]
        near = np.minimum(np.abs(g[:-1]), np.abs(g[1:])) <= NEAR * np.abs(g).max(axis=0)
        for k, event in np.argwhere(turns & near):
            part = rates[k, event] / (rates[k, event] - rates[k + 1, event])
            y = self._between(rows[k], rows[k + 1], part)
            t = rows[k, 0] + part * steps[k]
            if self._touched(t, y, event, len(rows)):
                name = writer(self._dynamics.system, "event_function", int(event))
                raise SolverError(
                    f"sensitivities: found that '{name}' grazes its breakpoint at t = {t:.9g} s, within the integration error, where "
                    "the motion is not differentiable with respect to parameters; expected an event that crosses it or stays clear of it"
                )

    def _take(self, t: float, y: np.ndarray) -> None:
        state, lam = self._dynamics.state, self._recorder.equations.at["lam"]
        solved = lam != ABSENT
        state.q[:], state.u[:] = self._recorder.split(y)
        state.lam[solved] = y[lam[solved]]

    def _values(self, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the event functions and their rates at a recorded state."""
        n, lam = self._recorder.equations.n, self._recorder.equations.at["lam"]
        y, yp = row[2 : 2 + n], row[2 + n :]
        self._take(row[0], y)
        direction, solved = self._by_time, lam != ABSENT
        direction.q[:], direction.u[:] = self._recorder.split(yp)
        direction.lam[solved] = yp[lam[solved]]
        direction.evaluate(row[0], 1.0)
        return self._dynamics.state.values["event_function"][: self._count].copy(), direction.values[
            : self._count
        ].copy()

    def _between(self, before: np.ndarray, after: np.ndarray, part: float) -> np.ndarray:
        """Return the state within a step, by cubic Hermite interpolation."""
        n, h = self._recorder.equations.n, after[0] - before[0]
        (y, yp), (z, zp) = ((row[2 : 2 + n], row[2 + n :]) for row in (before, after))
        s = part
        return np.asarray(
            (1 + 2 * s) * (1 - s) ** 2 * y
            + s * (1 - s) ** 2 * h * yp
            + s * s * (3 - 2 * s) * z
            + s * s * (s - 1) * h * zp
        )

    def _touched(self, t: float, y: np.ndarray, event: int, steps: int) -> bool:
        """Return True if an event function is zero within the integration error, and rates are discontinuous there."""
        tolerance = steps * (self._recorder.settings.rtol * np.abs(y) + self._atol)
        slope = self._slope(t, y, event, tolerance)
        margin = float(np.abs(slope) @ tolerance)
        here = self._value(t, y, event)
        if not abs(here) <= margin:
            return False
        way = np.sign(slope) * tolerance / margin
        near, far = (self._change(t, y, way, -here, size) for size in (2 * margin, 2 * FURTHER * margin))
        return bool(np.any((near > LINEAR * far) & (near > 0)))

    def _slope(self, t: float, y: np.ndarray, event: int, moves: np.ndarray) -> np.ndarray:
        """Return the derivatives of an event function with respect to the state, by differences over the tolerances."""
        slope, at = np.zeros(len(y)), self._recorder.equations.independent
        for k in at[moves[at] > 0]:
            moved = np.zeros(len(y))
            moved[k] = moves[k]
            slope[k] = (self._value(t, y + moved, event) - self._value(t, y - moved, event)) / (2 * moves[k])
        return slope

    def _value(self, t: float, y: np.ndarray, event: int) -> float:
        self._take(t, y)
        self._dynamics.state.evaluate("event_function", t)
        return float(self._dynamics.state.values["event_function"][event])

    def _change(self, t: float, y: np.ndarray, way: np.ndarray, to_zero: float, size: float) -> np.ndarray:
        """Return the difference between the rates on both sides of the breakpoint."""
        one, other = (np.concatenate(list(self._rates(t, y + (to_zero + side * size) * way))) for side in (-1, 1))
        return np.asarray(np.abs(other - one))

    def _rates(self, t: float, y: np.ndarray) -> Iterator[np.ndarray]:
        self._take(t, y)
        _, acceleration = self._dynamics.accelerate(t)
        yield acceleration.copy()
        first = self._dynamics.system.first_state
        yield self._dynamics.position_rates(self._dynamics.state.q, self._dynamics.state.u)[first:]
