"""Checks of a run on its own motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from ..dynamics.dynamics import Dynamics, OutputRows
from ..elements.element import Joint
from ..results.joint_angles import joint_angles
from .lost_turns import lost_turns_sentence
from .near_limits import near_limits_sentence
from .singular_passage import singular_passage_sentence


def motion_notes(
    dynamics: Dynamics,
    rows: OutputRows,
    rtol: float,
    again: Callable[[np.ndarray], OutputRows],
    joints: Mapping[str, Joint],
) -> Iterator[str]:
    """Yield sentences on results that depend on rounding or tolerances: singular poses, missed turns, forces out of range.

    The state of `dynamics`, of the whole model, is changed; `again` is a rerun up to the last of other times, s, with rows
    at these.
    """
    if rows.lam.size:
        yield from singular_passage_sentence(dynamics, rows, rtol, again)
    if dynamics.system.n_counters:
        yield from lost_turns_sentence(dynamics, rows)
    if (angles := joint_angles(dynamics.system, joints)) is not None:
        yield from angles.uncertain(rows)
    if dynamics.system.has_limits:
        yield from near_limits_sentence(dynamics, rows)
