"""Targets of metrics: ranges in which the metrics of handling tests, or the measures of an axle, are to lie."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

from ..errors import InputError
from ..reading.did_you_mean import did_you_mean, instead_of
from ..reading.files.quoted import quoted
from ..reading.formula.text import FormulaError
from ..reading.units.quantity import quantity

YES_OR_NO = " (1 yes, 0 no)"
"""End of the names of metrics that are answers."""
_ANSWERS = {"yes": 1.0, "no": 0.0}
_BOUND = re.compile(r"(?P<number>[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?)?\s*(?P<unit>\D.*)?", re.IGNORECASE)
_QUOTIENT = re.compile(r"\(([^()]*)\)")


class Metric(NamedTuple):
    """Metric of a result: its values by side, ``""`` for a single one, and their unit."""

    values: dict[str, float]
    unit: str


@dataclass(frozen=True)
class Target:
    """Range in which a metric is to lie, with the values that were found.

    Attributes
    ----------
    name : str
        Name of the metric, as `key_of` writes it.
    low, high : float
        Bounds in the unit of the metric; infinite where there is none.
    metric : Metric
    """

    name: str
    low: float
    high: float
    metric: Metric

    @property
    def met(self) -> bool:
        """Return True if all values lie in the range; a value without a number does not."""
        return all(self.low <= value <= self.high for value in self.metric.values.values())


def key_of(name: str) -> str:
    """Return the name of a metric as targets write it: ``yaw rate, overshoot`` as ``yaw_rate_overshoot``."""
    return re.sub(r"[^a-z0-9.]+", "_", name.removesuffix(YES_OR_NO).casefold()).strip("_")


def checked_targets(given: Mapping[str, str], tests: Collection[str] = ()) -> dict[str, str]:
    """Return the texts of targets by the keys of their metrics.

    `tests`: tests with which the names of metrics begin. Raises InputError for a text that is no range, or for another test.
    """
    for name, text in given.items():
        _range(name, text)
        test = name.partition(".")[0]
        if tests and test not in tests:
            raise InputError(f"target {name}: found the test '{quoted(test)}'{instead_of(test, tests)}")
    return {key_of(name): text for name, text in given.items()}


def judged(given: Mapping[str, str], metrics: Mapping[str, Metric]) -> tuple[Target, ...]:
    """Return targets with the values of their metrics.

    Parameters
    ----------
    given : mapping of str to str
        Ranges by the name of a metric: ``{"step_steer.yaw_rate_overshoot": ":15 %"}``. A range is ``LOW:HIGH``,
        ``LOW:`` or ``:HIGH``, in the unit of the metric or with a unit of its own; ``yes`` or ``no`` for an answer.
    metrics : mapping of str to Metric

    Raises
    ------
    InputError
        If there is no such metric, or the text is no range in a unit of the metric.
    """
    known = {key_of(name): metric for name, metric in metrics.items()}
    return tuple(_target(name, text, known) for name, text in given.items())


def _target(name: str, text: str, known: Mapping[str, Metric]) -> Target:
    key = key_of(name)
    if key not in known:
        raise InputError(
            f"target {name}: found no metric '{quoted(name)}'{did_you_mean(key, known)}, expected one of {_choices(key, known)}"
        )
    low, high, unit = _range(name, text)
    factor = _factor(name, unit, known[key].unit)
    return Target(key, low * factor, high * factor, known[key])


def _choices(key: str, known: Iterable[str]) -> str:
    """Return the metrics of the same test or load case, or else all tests and load cases."""
    names = list(known)
    of_test = [name for name in names if name.rpartition(".")[0] == key.rpartition(".")[0]]
    return ", ".join(of_test or dict.fromkeys(name.partition(".")[0] for name in names))


def _range(name: str, text: str) -> tuple[float, float, str]:
    """Return the bounds of a range and its unit, that of the upper bound for both; empty for the unit of the metric."""
    if text.strip() in _ANSWERS:
        answer = _ANSWERS[text.strip()]
        return answer, answer, ""
    first, colon, second = text.partition(":")
    bounds = [_BOUND.fullmatch(part.strip()) for part in (first, second)]
    if not colon or not all(bounds) or not any(bound and bound["number"] for bound in bounds):
        raise InputError(f"target {name}: found '{quoted(text)}', expected a range such as 0.1:0.3, :15 or 2: 4 deg")
    (low, unit_of_low), (high, unit) = (
        (bound["number"], (bound["unit"] or "").strip()) for bound in bounds if bound is not None
    )
    if unit and unit_of_low not in ("", unit):
        raise InputError(f"target {name}: found '{quoted(text)}', expected one unit for both bounds")
    found = float(low) if low else -math.inf, float(high) if high else math.inf
    if found[0] > found[1]:
        raise InputError(f"target {name}: found '{quoted(text)}', expected the lower bound first")
    return *found, unit or unit_of_low


def _factor(name: str, unit: str, of_metric: str) -> float:
    """Return the factor from a unit to that of the metric."""
    if unit in ("", of_metric):
        return 1.0
    with suppress(FormulaError):  # of a unit that scenes do not know, such as %
        given, own = (quantity(f"1 {_without_brackets(each)}") for each in (unit, of_metric))
        if given.dimension == own.dimension:
            return given.value / own.value
    raise InputError(f"target {name}: found the unit '{quoted(unit)}', expected {of_metric or 'no unit'}")


def _without_brackets(unit: str) -> str:
    """Return a unit without a quotient in its denominator: ``mrad/(m/s^2)`` as ``mrad s^2/m``."""
    found = _QUOTIENT.search(unit)
    if not found:
        return unit
    over, _, under = found[1].partition("/")
    return f"{unit[: found.start()].rstrip('/')} {under}/{over}"
