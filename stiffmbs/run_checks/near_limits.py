"""A note on forces that come near the limits of their laws: the motion goes on, but no mechanism is built for it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compile.system import System
from ..solve.dynamics import Dynamics, OutputRows

MOST_INSTANTS = 400
"""Instants that are looked at."""


def near_limits_sentence(dynamics: Dynamics, rows: OutputRows) -> Iterator[str]:
    """The first force that comes where its kind calls a motion doubtful, in a sentence; nothing where none does.

    Parameters
    ----------
    dynamics : Dynamics
        Of the whole; its state is changed.
    rows : OutputRows
        Of the run.
    """
    system, state = dynamics.system, dynamics.state
    first, end = system.first_limit, system.n_event_functions
    if not len(rows.t):
        return
    doubtful, words = _doubts(system)
    for k in np.unique(np.linspace(0, len(rows.t) - 1, min(len(rows.t), MOST_INSTANTS)).astype(int)):
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
    """For each limit of a force, the value below which the motion is doubtful, and what is doubtful there."""
    found = [
        (group.kind.element.doubtful, f"'{name}' {group.kind.element.doubt}")  # type: ignore[attr-defined]
        for group in system.groups
        if group.entries["limit"]
        for name in group.names
        for _ in range(group.entries["limit"])
    ]
    return np.array([value for value, _ in found]), tuple(words for _, words in found)
