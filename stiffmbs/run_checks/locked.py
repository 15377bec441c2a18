"""Early end of a run although the integrator continued: a mechanism locks, or its joints contradict each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..compile.state import LEFT_OPEN
from ..dynamics.dynamics import Dynamics
from ..notes import Note
from ..redundancy.listed import listed
from ..redundancy.redundancy import Redundancy
from ..redundancy.uniqueness import unproven
from ..solve.reasons import Reason
from ..solve.trajectory import Trajectory
from .parameters import RUN_CHECKS
from .singular_poses import some_instants


def locked(dynamics: Dynamics, redundancy: Redundancy, solved: Trajectory) -> tuple[int, Note] | None:
    """Return the number of valid outputs (at least the start) and a sentence on the violation after them, or None."""
    equations = dynamics.system.equations
    velocity = unfollowed(dynamics, solved)
    if velocity is not None:
        output, row, gap = velocity
        joint, equation = equations[row]
        return max(1, output), Reason.LOCKED.of(
            f"stopped before t = {solved.t[output]:.6g} s: joint '{joint}' (equation {equation}) is violated there by a velocity of "
            f"{gap:.3g}: the mechanism locks, or the other joints do not allow a prescribed velocity",
            joint,
        )
    others = unproven(redundancy)
    rows = tuple(row for row in others if dynamics.system.holonomic[row])
    position = departure(dynamics, rows, solved) if rows else None
    if position is None:
        return None
    output, t, row = position
    joint, equation = equations[row]
    names = listed(list(dict.fromkeys(equations[other][0] for other in others[row])) or [joint])
    return output + 1, Reason.LOCKED.of(
        f"stopped at t = {t:.6g} s: joint '{joint}' (equation {equation}), left out because near the start it is "
        f"redundant with {names}, is violated there: the joints lock or contradict each other",
        joint,
    )


def unfollowed(dynamics: Dynamics, solved: Trajectory) -> tuple[int, int, float] | None:
    """Return the first output at which a nonholonomic equation does not hold, its row, and the violation, m/s or rad/s.

    The relaxed formulation lets velocities drift if multipliers grow without bound. Holonomic equations cannot remain
    violated in this way. The state of `dynamics` is changed.
    """
    rows = np.flatnonzero(dynamics.system.active & ~dynamics.system.holonomic)
    if not len(rows):
        return None
    outputs = some_instants(len(solved.t))  # a mechanism that has locked violates its drive at later outputs too
    seen = _first(dynamics, rows, solved, outputs)
    if seen is None:
        return None
    before = outputs[max(int(np.searchsorted(outputs, seen[0])) - 1, 0)]
    return _first(dynamics, rows, solved, np.arange(before, seen[0] + 1))


def _first(
    dynamics: Dynamics, rows: np.ndarray, solved: Trajectory, outputs: np.ndarray
) -> tuple[int, int, float] | None:
    """Return the first of some outputs at which one of some equations is violated too much, its row, and the violation."""
    system, (t, q, u) = dynamics.system, (each[outputs] for each in (solved.t, solved.q, solved.u))
    V, J = system.term("motion", "V"), system.term("motion", "J")
    used = np.isin(J.row, rows)
    places = np.concatenate([V.source, J.source[used]])
    violations, coefficients = np.hsplit(dynamics.state.values_at("motion", places, t, q, u), [len(V.source)])
    gaps, sizes = np.zeros((2, len(outputs), system.n_c))
    gaps[:, V.row] = np.abs(violations)
    np.add.at(sizes.T, J.row[used], np.abs(coefficients * u[:, J.column[used]]).T)
    excess = (gaps - np.maximum(RUN_CHECKS.unfollowed_part * sizes, RUN_CHECKS.unfollowed_velocity))[:, rows]
    wrong = np.flatnonzero(np.any(excess > 0, axis=1))
    if not len(wrong):
        return None
    k = int(wrong[0])
    worst = int(rows[np.argmax(excess[k])])
    return int(outputs[k]), worst, float(gaps[k, worst])


def departure(dynamics: Dynamics, rows: Sequence[int], solved: Trajectory) -> tuple[int, float, int] | None:
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
    for output, t, q in _poses(dynamics, solved):
        state.q[:] = q
        state.restart_counters(t)
        state.evaluate("position", t)
        values = np.abs(state.values["position"])
        gaps = values[left_out]
        if not gaps.max() > allowed + RUN_CHECKS.left_out * values[kept].max(initial=0.0):
            continue
        assemblies += 1
        if dynamics.assemble(t) < 0:
            return output, t, rows[int(np.argmax(gaps))]
        if assemblies == RUN_CHECKS.most_assemblies:
            return None
    return None


def _poses(dynamics: Dynamics, solved: Trajectory) -> Iterator[tuple[int, float, np.ndarray]]:
    """Yield poses at outputs and on Hermite interpolants between them: number of the output before, time, s, pose."""
    of_body, bodies = dynamics.system.of_body, dynamics.system.of_body.n_q * len(dynamics.system.bodies)
    count = 1 + RUN_CHECKS.poses // len(solved.t)
    parts = np.arange(1, count + 1) / count
    for k in range(len(solved.t) - 1):
        h, q = solved.t[k + 1] - solved.t[k], solved.q[k]
        move = of_body.move(q[:bodies], solved.q[k + 1][:bodies])
        for s in parts:
            step = (3 - 2 * s) * s**2 * move + s * (1 - s) * h * ((1 - s) * solved.u[k] - s * solved.u[k + 1])
            yield k, float(solved.t[k] + s * h), of_body.moved(q, step)
