"""The legs of a run that changed hands between two integrators, as one trajectory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .trajectory import History, Trajectory, summed


def joined(legs: Sequence[Trajectory]) -> Trajectory:
    """Legs as one trajectory; each begins with the row at which the last one ended."""
    t, q, u = (
        np.concatenate([getattr(leg, name)[int(k > 0) :] for k, leg in enumerate(legs)]) for name in ("t", "q", "u")
    )
    return replace(legs[-1], t=t, q=q, u=u, statistics=_summed(legs), history=_history(legs))


def _last_of_each_kind(legs: Sequence[Trajectory]) -> list[Trajectory]:
    """Every explicit leg, and the last implicit one: its integrator counts from its first start on."""
    implicit = [leg for leg in legs if leg.solver == "bdf"]
    return [leg for leg in legs if leg.solver != "bdf"] + implicit[-1:]


def _summed(legs: Sequence[Trajectory]) -> dict[str, int | float | str]:
    """The counters of all legs, and their time."""
    seconds = summed([{"seconds": leg.statistics["seconds"]} for leg in legs])
    return {**summed([leg.statistics for leg in _last_of_each_kind(legs)]), **seconds}


def _history(legs: Sequence[Trajectory]) -> History:
    """The steps of all legs; orders where all are known."""
    t = np.concatenate([leg.history.t for leg in _last_of_each_kind(legs)])
    return History(np.sort(t), np.empty(0, dtype=int))
