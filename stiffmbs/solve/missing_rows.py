"""Output rows past isolated times without accelerations and reactions, such as an exactly singular pose."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.storage import FAILURES
from ..notes import Note, NoteKind
from .stiff_rows import lengths_of_steps, with_stiff_forces
from .trajectory import Trajectory

MISSING = NoteKind("missing-row", "no accelerations and reactions at t = {t:.9g} s (NaN there): {reason}")
MOST_MISSING = 100
"""Largest number of gaps; the rows end after it."""


def reported(dynamics: Dynamics, trajectory: Trajectory, project: bool, rtol: float) -> tuple[OutputRows, list[Note]]:
    """Return the output rows of a trajectory, and a note for each row without a solution.

    Projections change forces by less than `rtol` of the largest, if possible. A time without a solution between two that
    have one keeps its integrated coordinates and velocities; all else is NaN. The rows end where two in succession have none.
    """
    t, q, u = trajectory.t, trajectory.q, trajectory.u
    parts: list[OutputRows] = [dynamics.report(t, q, u, project)]
    notes: list[Note] = []
    done = len(parts[0].t)
    while 0 < done < len(t) - 1 and len(notes) < MOST_MISSING:
        status = parts[-1].status
        if not len(dynamics.report(t[done + 1 : done + 2], q[done + 1 : done + 2], u[done + 1 : done + 2], project).t):
            break
        following = dynamics.report(t[done + 1 :], q[done + 1 :], u[done + 1 :], project)
        pose = dynamics.system.of_body.moved(q[done], np.zeros_like(u[done]))  # quaternions of length 1
        parts += [_unknown(parts[0], t[done], pose, u[done]), following]
        notes.append(MISSING(t=t[done], reason=FAILURES[status]))
        done += 1 + len(following.t)
    return with_stiff_forces(dynamics, (q, u), joined_rows(parts), lengths_of_steps(trajectory), rtol), notes


def _unknown(like: OutputRows, t: float, q: np.ndarray, u: np.ndarray) -> OutputRows:
    """Return a row of NaN except for time, coordinates and velocities."""
    known: dict[str, Any] = {"t": np.array([t]), "q": q[None], "u": u[None], "status": 0}
    for name in (field.name for field in fields(OutputRows) if field.name not in known):
        known[name] = np.full((1, *getattr(like, name).shape[1:]), np.nan)
    return OutputRows(**known)


def joined_rows(parts: list[OutputRows]) -> OutputRows:
    """Return the rows of several reports as one."""
    if len(parts) == 1:
        return parts[0]
    names = [field.name for field in fields(OutputRows) if field.name != "status"]
    joined: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return OutputRows(**joined, status=parts[-1].status)
