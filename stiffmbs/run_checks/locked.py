"""Early end of a run although the integrator continued: a mechanism locks, or its joints contradict each other."""

from __future__ import annotations

from ..dynamics.dynamics import Dynamics
from ..redundancy.overconstraint import listed
from ..redundancy.redundancy import Redundancy
from ..redundancy.unproven import unproven
from ..solve.trajectory import Trajectory
from .departures import departure
from .unfollowed import unfollowed


def locked(dynamics: Dynamics, redundancy: Redundancy, way: Trajectory) -> tuple[int, str] | None:
    """Return the number of valid outputs (at least the start) and a sentence on the violation after them, or None."""
    equations = dynamics.system.equations
    velocity = unfollowed(dynamics, way)
    if velocity is not None:
        output, row, gap = velocity
        joint, equation = equations[row]
        return max(1, output), (
            f"stopped before t = {way.t[output]:.6g} s: joint '{joint}' (equation {equation}) is not followed there, its velocity is "
            f"off by {gap:.3g}: the mechanism locks, or a prescribed velocity asks for more than the other joints allow"
        )
    others = unproven(redundancy)
    rows = tuple(row for row in others if dynamics.system.holonomic[row])
    position = departure(dynamics, rows, way) if rows else None
    if position is None:
        return None
    output, t, row = position
    joint, equation = equations[row]
    names = listed(list(dict.fromkeys(equations[other][0] for other in others[row])) or [joint])
    return output + 1, (
        f"stopped at t = {t:.6g} s: joint '{joint}' (equation {equation}) was left out, as near the start it holds the same "
        f"as {names}; it does not hold there, so that the joints lock or contradict each other"
    )
