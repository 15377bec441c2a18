"""The legs of a run that switched between two integrators, as one trajectory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .solver import Traits
from .trajectory import History, Trajectory, summed


@dataclass(frozen=True)
class Leg:
    """A part of a run, and what solved it."""

    trajectory: Trajectory
    traits: Traits


def joined(legs: Sequence[Leg]) -> Trajectory:
    """Legs as one trajectory; each begins with the row at which the last one ended."""
    parts = [leg.trajectory for leg in legs]
    t, q, u = (
        np.concatenate([getattr(part, name)[int(k > 0) :] for k, part in enumerate(parts)]) for name in ("t", "q", "u")
    )
    counted = _last_of_each_kind(legs)
    return replace(parts[-1], t=t, q=q, u=u, statistics=_summed(parts, counted), history=_history(counted))


def _last_of_each_kind(legs: Sequence[Leg]) -> list[Trajectory]:
    """Every explicit leg, and the last implicit one: its integrator counts from its first start on."""
    explicit = [leg.trajectory for leg in legs if not leg.traits.implicit]
    return explicit + [leg.trajectory for leg in legs if leg.traits.implicit][-1:]


def _summed(legs: Sequence[Trajectory], counted: Sequence[Trajectory]) -> dict[str, int | float | str]:
    """The counters of those that count, and the time of all."""
    seconds = summed([{"seconds": leg.statistics["seconds"]} for leg in legs])
    return {**summed([leg.statistics for leg in counted]), **seconds}


def _history(counted: Sequence[Trajectory]) -> History:
    """The steps of all legs; orders where all are known."""
    t = np.concatenate([leg.history.t for leg in counted])
    return History(np.sort(t), np.empty(0, dtype=int))
