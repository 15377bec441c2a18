"""Ranges of parameters, scaled to numbers from 0 to 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InputError
from .variation import Range


@dataclass(frozen=True)
class Sought:
    """Parameters within ranges, as points of the unit cube.

    Attributes
    ----------
    names : tuple of str
    ranges : tuple of Range
    """

    names: tuple[str, ...]
    ranges: tuple[Range, ...]

    def values(self, point: np.ndarray) -> list[float]:
        """Return the values at a point, shape (n,)."""
        return [float(one.at(part)) for one, part in zip(self.ranges, point, strict=True)]

    def point(self, values: Mapping[str, float]) -> np.ndarray:
        """Return the point of given values; missing values are the middle of their range.

        Raises
        ------
        InputError
            If a value is out of its range, or belongs to no parameter.
        """
        for name in values:
            if name not in self.names:
                raise InputError(f"start: found '{name}', expected one of {', '.join(self.names)}")
        return np.array([_part(name, one, values.get(name)) for name, one in zip(self.names, self.ranges, strict=True)])

    def slopes(self, point: np.ndarray) -> np.ndarray:
        """Return the derivatives of the values by the point's coordinates, shape (n,)."""
        spans = [np.log(one.high / one.low) if one.log else one.high - one.low for one in self.ranges]
        return np.array([
            span * (value if one.log else 1.0)
            for span, value, one in zip(spans, self.values(point), self.ranges, strict=True)
        ])  # fmt: skip


def sought(parameters: Mapping[str, Any]) -> Sought:
    """Return parameters with their ranges, each a `Range` or a pair of its ends.

    Raises
    ------
    InputError
        If there is no parameter, or a range is invalid.
    """
    if not parameters:
        raise InputError("parameters: found none, expected one or more with their ranges")
    return Sought(tuple(parameters), tuple(_range(name, found) for name, found in parameters.items()))


def _range(name: str, found: Any) -> Range:
    if isinstance(found, Range):
        return found
    try:
        low, high = found
        return Range(float(low), float(high))
    except (TypeError, ValueError):
        raise InputError(
            f"{name}: found {found!r}, expected a range: (low, high) or Range(low, high, log=True)"
        ) from None
    except InputError as error:
        raise InputError(f"{name}: {error}") from None


def _part(name: str, one: Range, value: float | None) -> float:
    if value is None:
        return 0.5
    if not one.low <= value <= one.high:
        raise InputError(f"start: found {name} = {value:g}, expected a value from {one.low:g} to {one.high:g}")
    if one.log:
        return float(np.log(value / one.low) / np.log(one.high / one.low))
    return (value - one.low) / (one.high - one.low)
