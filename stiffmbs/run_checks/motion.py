"""Checks of a run on its own motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..solve.dynamics import Dynamics, OutputRows
from .glance import Glance
from .growth import senseless
from .lost_turns import lost_turns_sentence
from .near_limits import near_limits_sentence
from .singular_passage import singular_passage_sentence


class MotionNotes(NamedTuple):
    """Sentences on a motion.

    Attributes
    ----------
    senseless : tuple of str
        Impossible results: unbounded growth, open joints.
    uncertain : tuple of str
        Results that depend on rounding or tolerances: singular poses, missed revolutions, forces outside their range.
    """

    senseless: tuple[str, ...]
    uncertain: tuple[str, ...]


def motion_notes(
    dynamics: Dynamics, rows: OutputRows, on_constraints: bool, seen: Glance | None, rtol: float,
    again: Callable[[np.ndarray], OutputRows],
) -> MotionNotes:  # fmt: skip
    """Return the notes on a motion.

    Parameters
    ----------
    dynamics : Dynamics
        Of the whole model; its state is changed.
    rows : OutputRows
    on_constraints : bool
        Whether states are projected onto the constraints, so that drift is not shown.
    seen : Glance or None
        Result of the scan.
    rtol : float
        Of the run.
    again : callable
        Rerun up to the last of other times, s, and report at these.
    """
    return MotionNotes(
        tuple(senseless(dynamics, rows, on_constraints, seen)),
        (
            *(singular_passage_sentence(dynamics, rows, rtol, again) if rows.lam.size else ()),
            *(lost_turns_sentence(dynamics, rows) if dynamics.system.n_counters else ()),
            *(near_limits_sentence(dynamics, rows) if dynamics.system.has_limits else ()),
        ),
    )
