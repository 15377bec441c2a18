"""Note on forces near the limits of their laws, in motions for which no mechanism is designed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from .instants import some_instants


def near_limits_sentence(dynamics: Dynamics, rows: OutputRows) -> Iterator[str]:
    """Yield a sentence on the first force outside the range in which its kind is reliable; the state is changed."""
    system, state = dynamics.system, dynamics.state
    first, end = system.first_limit, system.n_event_functions
    if not len(rows.t):
        return
    doubtful, words = _doubts(system)
    for k in some_instants(len(rows.t)):
        state.q[:], state.u[:] = rows.q[k], rows.u[k]
        state.evaluate("event_function", rows.t[k])
        passed = np.flatnonzero(state.values["event_function"][first:end] < doubtful)
        if len(passed):
            yield (
                f"{words[passed[0]]}, first seen at t = {rows.t[k]:.6g} s; a vibration that has grown, as shimmy, may come to that, "
                "and the motion may then depend on the tolerances: look at it with --verify, and at its growth with "
                "'stiffmbs modes' and an earlier --at"
            )
            return


def _doubts(system: System) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return, for each limit of a force, the value below which the motion is doubtful, and the doubt."""
    found = [
        (group.kind.element.doubtful, f"'{name}' {group.kind.element.doubt}")  # type: ignore[attr-defined]
        for group in system.groups
        if group.entries["limit"]
        for name in group.names
        for _ in range(group.entries["limit"])
    ]
    return np.array([value for value, _ in found]), tuple(words for _, words in found)
