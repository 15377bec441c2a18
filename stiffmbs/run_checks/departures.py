"""Detection of dropped equations that cease to hold during a run, as they were redundant near the start only."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..compile.state import LEFT_OPEN
from ..dynamics.dynamics import Dynamics
from ..solve.trajectory import Trajectory

POSES = 10_000
"""Number of poses to check in the whole motion, with one for each output at least."""
LEFT_OUT = 10.0
"""Largest violation of dropped equations, relative to that of the others, that is due to interpolation."""
MOST_ASSEMBLIES = 500
"""Largest number of poses between outputs that are assembled."""


def departure(dynamics: Dynamics, rows: Sequence[int], way: Trajectory) -> tuple[int, float, int] | None:
    """Return the last output before a violation of dropped rows where the others hold, its time, s, and row; or None.

    Poses between outputs are interpolated. A pose is assembled if the violation of dropped rows exceeds that due to
    interpolation. The state of `dynamics` is changed.
    """
    system, state = dynamics.system, dynamics.state
    source, row = system.term("position", "C").source, system.term("position", "C").row
    place = np.empty(system.n_c, dtype=np.int64)
    place[row] = source
    left_out, kept = place[list(rows)], place[system.active & system.holonomic]
    allowed, assemblies = LEFT_OPEN * min(1.0, system.size), 0
    for output, t, q in _poses(dynamics, way):
        state.q[:] = q
        state.count_anew(t)
        state.evaluate("position", t)
        values = np.abs(state.values["position"])
        gaps = values[left_out]
        if not gaps.max() > allowed + LEFT_OUT * values[kept].max(initial=0.0):
            continue
        assemblies += 1
        if dynamics.assemble(t) < 0:
            return output, t, rows[int(np.argmax(gaps))]
        if assemblies == MOST_ASSEMBLIES:
            return None
    return None


def _poses(dynamics: Dynamics, way: Trajectory) -> Iterator[tuple[int, float, np.ndarray]]:
    """Yield poses at outputs and on Hermite interpolants between them: number of the output before, time, s, pose."""
    of_body, bodies = dynamics.system.of_body, dynamics.system.of_body.n_q * len(dynamics.system.bodies)
    count = 1 + POSES // len(way.t)
    parts = np.arange(1, count + 1) / count
    for k in range(len(way.t) - 1):
        h, q = way.t[k + 1] - way.t[k], way.q[k]
        move = of_body.move(q[:bodies], way.q[k + 1][:bodies])
        for s in parts:
            step = (3 - 2 * s) * s**2 * move + s * (1 - s) * h * ((1 - s) * way.u[k] - s * way.u[k + 1])
            yield k, float(way.t[k] + s * h), of_body.moved(q, step)
