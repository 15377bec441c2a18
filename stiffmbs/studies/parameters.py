"""Ranges of parameters, scaled to numbers from 0 to 1, and derivatives of outputs by them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..analyses.job import Job, prepare
from ..analyses.renumber import renumbered
from ..errors import InputError
from ..model.files.written_scene import WrittenScene
from ..model.settings import RunSettings
from ..reading.did_you_mean import instead_of
from ..reading.variation import Range, Variation, variation
from .case_solver import refuse_units
from .sensitivities.parameters import Scenes
from .sensitivities.sensitivities import DifferentiatedRun, differentiable


@dataclass(frozen=True)
class ParameterRanges:
    """Parameters within ranges, as points of the unit cube."""

    names: tuple[str, ...]
    ranges: tuple[Range, ...]

    def values(self, point: np.ndarray) -> list[float]:
        """Return the values at a point, shape (n,)."""
        return [float(one.at(part)) for one, part in zip(self.ranges, point, strict=True)]

    def point(self, values: Mapping[str, float]) -> np.ndarray:
        """Return the point of given values; missing values are the middle of their range.

        Raises InputError if a value is out of its range, or belongs to no parameter.
        """
        for name in values:
            if name not in self.names:
                raise InputError(f"start: found '{name}'{instead_of(name, self.names)}")
        return np.array([_part(name, one, values.get(name)) for name, one in zip(self.names, self.ranges, strict=True)])

    def slopes(self, point: np.ndarray) -> np.ndarray:
        """Return the derivatives of the values by the point's coordinates, shape (n,)."""
        spans = [np.log(one.high / one.low) if one.log else one.high - one.low for one in self.ranges]
        return np.array([
            span * (value if one.log else 1.0)
            for span, value, one in zip(spans, self.values(point), self.ranges, strict=True)
        ])  # fmt: skip


def parameter_ranges(parameters: Mapping[str, object], scene: WrittenScene) -> ParameterRanges:
    """Return parameters of a scene with their ranges, each a `Range`, its text, or a pair of its ends.

    Raises InputError if there is no parameter, or a range is invalid.
    """
    if not parameters:
        raise InputError("parameters: found none, expected one or more with their ranges")
    found = [_bounded(name, given) for name, given in parameters.items()]
    refuse_units(scene, found)
    return ParameterRanges(tuple(parameters), tuple(one.range for one in found if one.range))


def central_differences(function: Callable[[np.ndarray], np.ndarray], point: np.ndarray, step: float) -> np.ndarray:
    """Return the derivatives of a function at a point of the unit cube, a column for each coordinate.

    Differences are central, and one-sided at the bounds.
    """
    columns = []
    for k in range(len(point)):
        ends = [point.copy(), point.copy()]
        ends[0][k], ends[1][k] = max(point[k] - step, 0.0), min(point[k] + step, 1.0)
        below, above = map(function, ends)
        columns.append((above - below) / (ends[1][k] - ends[0][k]))
    return np.column_stack(columns)


def _bounded(name: str, given: Any) -> Variation:
    if not isinstance(given, str | Range | Variation):
        try:
            low, high = given
            given = Range(float(low), float(high))
        except (TypeError, ValueError):
            raise InputError(
                f"{name}: found {given!r}, expected a range: (low, high), Range(low, high, log=True) or 'FROM:TO:log'"
            ) from None
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
    found = variation(name, given)
    if found.range is None or found.range.count:
        raise InputError(f"{name}: found no range, or one with a count; expected FROM:TO or FROM:TO:log")
    return found


def _part(name: str, one: Range, value: float | None) -> float:
    if value is None:
        return 0.5
    if not one.low <= value <= one.high:
        raise InputError(f"start: found {name} = {value:g}, expected a value from {one.low:g} to {one.high:g}")
    if one.log:
        return float(np.log(value / one.low) / np.log(one.high / one.low))
    return (value - one.low) / (one.high - one.low)


class Gradients:
    """Derivatives of outputs; data common to all points is read and compiled once.

    `texts`: outputs, formulas of channels. `times`: output instants that replace those of the settings.
    """

    def __init__(
        self, written: WrittenScene, ranges: ParameterRanges, texts: Sequence[str], settings: RunSettings,
        times: np.ndarray | None = None,
    ) -> None:  # fmt: skip
        self._scenes, self._ranges, self._texts = Scenes(written), ranges, texts
        self._settings, self._times = differentiable(settings), times
        self._job: Job | None = None

    def at(self, point: np.ndarray) -> list[np.ndarray]:
        """Return the derivatives of each output by the coordinates of a point, shape (..., parameters).

        Raises StiffmbsError as for `stiffmbs.sensitivities`.
        """
        names, values = self._ranges.names, self._ranges.values(point)
        scenes = self._scenes.at(list(zip(names, values, strict=True)))
        known = self._job and renumbered(self._job, scenes.known)
        self._job = known or prepare(scenes.known, self._settings)
        run = DifferentiatedRun(scenes, names, self._job, self._times)
        spans = self._ranges.slopes(point)
        return [
            np.stack([found.to[name] for name in names], axis=-1) * spans for found in run.sensitivities(self._texts)
        ]
