"""Accuracy of steps of fixed length: their largest differences from a run with error control."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..analyses.run import run
from ..comparison.measures import ROTATION, compared, difference
from ..model.model_data import ModelData
from ..model.settings import RunSettings
from ..results.scales import UNITS, kind_of
from ..results.solution import Solution
from ..solve.settings import changed, traits_of
from ..solve.trajectory import Outcome

CONTROLLED = {"solver": "bdf", "scheme": None}
"""Settings of a run with error control for scenes whose own solver has fixed steps."""
TURNED = "rotation"
"""Kind of the difference of two orientations of a body in space."""


@dataclass(frozen=True)
class Difference:
    """Largest difference of a kind of channels from a run with error control.

    - `kind`, `unit`: kind of the channels, such as ``force``, and its unit.
    - `channel`: channel with this difference.
    - `largest`: the difference, in the unit.
    - `t`: its time, s.
    - `size`: largest value of this channel, in the unit; for places, its largest change, NaN for rotations.
    """

    kind: str
    channel: str
    largest: float
    unit: str
    t: float
    size: float


@dataclass(frozen=True)
class Accuracy:
    """Differences from a run with error control.

    - `solver`: solver and tolerance of this run.
    - `end`: time up to which runs are compared, s.
    - `differences`: one for each kind of channels.
    - `message`: reason why there are none, or why the comparison ends early; otherwise empty.
    - `controlled`: solution of this run, if any.
    """

    solver: str
    end: float
    differences: tuple[Difference, ...]
    message: str
    controlled: Solution | None

    @classmethod
    def unknown(cls, reason: str) -> Accuracy:
        """Return an accuracy that is not determined for a reason."""
        return cls("", np.nan, (), reason, None)


def accuracy(steps: Solution, data: ModelData, own: RunSettings) -> Accuracy:
    """Return the differences of a solution from a run with error control of the same model, at the same instants.

    `own`: settings of the run, whose solver is used unless it has fixed steps.
    """
    settings = _controlled(own, steps.time)
    controlled = run(data, settings)
    traits = traits_of(settings)
    name = traits.name if traits.exact else f"{traits.name} at rtol {settings.rtol:g}"
    message = "" if controlled.outcome is Outcome.DONE else f"the run by {name} ended early: {controlled.message}"
    count = min(len(steps.time), len(controlled.time))
    return Accuracy(name, float(controlled.time[count - 1]), tuple(differences(steps, controlled)), message, controlled)


def _controlled(own: RunSettings, times: np.ndarray) -> RunSettings:
    """Return the settings of a run with error control and output at equally spaced times."""
    control = CONTROLLED if traits_of(own).fixed_steps else {}
    span = float(times[-1] - times[0])
    return changed(
        own,
        {**control, "start": float(times[0]), "duration": span, "points": len(times), "errors": False, "accuracy": {}},
    )


def differences(steps: Solution, controlled: Solution) -> list[Difference]:
    """Return the largest difference of each kind of channels, over the time that both solutions have."""
    count = min(len(steps.time), len(controlled.time))
    one, other = ({name: values[:count] for name, values in each.channels.items()} for each in (steps, controlled))
    found: dict[str, Difference] = {}
    for names in compared(controlled).values():
        for name in names:
            turned = name.endswith(ROTATION) and name not in other
            kind, unit = (TURNED, "rad") if turned else (kind_of(name), UNITS[kind_of(name)])
            apart = difference(one, other, name)
            at = int(np.nanargmax(apart)) if np.isfinite(apart).any() else 0
            if kind not in found or apart[at] > found[kind].largest:
                size = np.nan if turned else _size(other[name], kind)
                found[kind] = Difference(kind, name, float(apart[at]), unit, float(controlled.time[at]), size)
    return list(found.values())


def _size(values: np.ndarray, kind: str) -> float:
    origin = values[0] if kind in ("position", "angle") else 0.0
    return float(np.nanmax(np.abs(values - origin)))
