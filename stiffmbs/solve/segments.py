"""Joining the segments of a run that switched between two integrators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .solver import Traits
from .trajectory import History, Trajectory, summed


@dataclass(frozen=True)
class Segment:
    """A part of a run, and the traits of its solver."""

    trajectory: Trajectory
    traits: Traits


def joined(segments: Sequence[Segment]) -> Trajectory:
    """Join segments to one trajectory; each begins with the last row of its predecessor."""
    parts = [segment.trajectory for segment in segments]
    t, q, u = (
        np.concatenate([getattr(part, name)[int(k > 0) :] for k, part in enumerate(parts)]) for name in ("t", "q", "u")
    )
    counted = _last_of_each_kind(segments)
    long_steps = tuple(steps for part in counted for steps in part.long_steps)
    statistics, history = _summed(parts, counted), _history(counted)
    return replace(
        parts[-1], t=t, q=q, u=u, statistics=statistics, history=history, long_steps=long_steps, recorded=(),
        departures=tuple(each for part in parts for each in part.departures),
    )  # fmt: skip


def _last_of_each_kind(segments: Sequence[Segment]) -> list[Trajectory]:
    """Return all explicit segments and the last implicit one, whose integrator counts from its first start."""
    explicit = [segment.trajectory for segment in segments if not segment.traits.implicit]
    return explicit + [segment.trajectory for segment in segments if segment.traits.implicit][-1:]


def _summed(segments: Sequence[Trajectory], counted: Sequence[Trajectory]) -> dict[str, int | float | str]:
    """Sum the statistics of some segments, and the time of all."""
    seconds = summed([{"seconds": segment.statistics["seconds"]} for segment in segments])
    return {**summed([segment.statistics for segment in counted]), **seconds}


def _history(counted: Sequence[Trajectory]) -> History:
    t = np.concatenate([segment.history.t for segment in counted])
    return History(np.sort(t), np.empty(0, dtype=int))
