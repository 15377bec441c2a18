"""Early end of a run although the integrator continued: a mechanism locks, or its joints contradict each other."""

from __future__ import annotations

from ..compile.system import System
from ..redundancy.overconstraint import listed
from ..redundancy.redundancy import Redundancy
from ..redundancy.unproven import unproven
from ..solve.dynamics import Dynamics
from ..solve.trajectory import Trajectory
from .departures import Departure, departure
from .unfollowed import Unfollowed, unfollowed


def locked(dynamics: Dynamics, redundancy: Redundancy, way: Trajectory) -> tuple[int, str] | None:
    """Return the number of valid outputs (at least the start) and a sentence on the violation after them, or None."""
    velocity = unfollowed(dynamics, way)
    if velocity is not None:
        return max(1, velocity.output), _unfollowed_sentence(dynamics.system, way, velocity)
    others = unproven(redundancy)
    rows = tuple(row for row in others if dynamics.system.holonomic[row])
    position = departure(dynamics, rows, way) if rows else None
    if position is not None:
        return position.output + 1, _departure_sentence(dynamics.system, position, others[position.row])
    return None


def _unfollowed_sentence(system: System, way: Trajectory, found: Unfollowed) -> str:
    joint, equation = system.equations[found.row]
    return (
        f"stopped before t = {way.t[found.output]:.6g} s: joint '{joint}' (equation {equation}) is not followed there, its velocity is "
        f"off by {found.gap:.3g}: the mechanism locks, or a prescribed velocity asks for more than the other joints allow"
    )


def _departure_sentence(system: System, found: Departure, others: tuple[int, ...]) -> str:
    joint, equation = system.equations[found.row]
    names = listed(list(dict.fromkeys(system.equations[row][0] for row in others)) or [joint])
    return (
        f"stopped at t = {found.t:.6g} s: joint '{joint}' (equation {equation}) was left out, as near the start it holds the same "
        f"as {names}; it does not hold there, so that the joints lock or contradict each other"
    )
