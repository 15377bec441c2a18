"""Parameters of the handling tests: one dataclass for each test, in SI units, and the changes of a user."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final, TypeVar

from ...errors import InputError, prefixed
from ...reading.did_you_mean import did_you_mean, instead_of
from ...reading.files.yaml_text import read_yaml
from ...reading.formula.text import FormulaError
from ...reading.units.quantity import in_si

Value = TypeVar("Value")
G: Final = 9.81
SPEED: Final = 80 / 3.6
"""Test speed of ISO 7401, ISO 4138 (constant speed) and ISO 19365, m/s."""


def parameter(default: Value, dimension: str, meaning: str, source: str = "") -> Value:
    """Return a field of a test: its default in SI units, dimension, meaning and the part of the standard it is from."""
    return field(default=default, metadata={"dimension": dimension, "meaning": meaning, "source": source})


@dataclass(frozen=True)
class ConstantSpeed:
    """Parameters of `constant_speed`."""

    speed: float = parameter(SPEED, "velocity", "speed of the ramp", "ISO 4138, constant speed")


@dataclass(frozen=True)
class ConstantRadius:
    """Parameters of `constant_radius`."""

    radius: float = parameter(100.0, "length", "radius of the circle", "ISO 4138, constant radius")
    first: float = parameter(5.0, "velocity", "speed at the start")
    last: float = parameter(20.0, "velocity", "speed at the end")
    acceleration: float = parameter(0.1, "acceleration", "rate of the speed, quasi-steady", "ISO 4138, constant radius")


@dataclass(frozen=True)
class StepSteer:
    """Parameters of `step_steer`."""

    speed: float = parameter(SPEED, "velocity", "speed", "ISO 7401, step input")
    lateral_acceleration: float = parameter(4.0, "acceleration", "steady value of the ramp", "ISO 7401, step input")
    rise: float = parameter(0.15, "time", "duration of the step", "ISO 7401, step input: at most 0.15 s")


@dataclass(frozen=True)
class FrequencySweep:
    """Parameters of `frequency_response`."""

    speed: float = parameter(SPEED, "velocity", "speed", "ISO 7401, continuous input")
    lateral_acceleration: float = parameter(2.0, "acceleration", "steady value of the amplitude")
    first: float = parameter(0.2, "frequency", "frequency at the start", "ISO 7401, continuous input")
    last: float = parameter(3.0, "frequency", "frequency at the end", "ISO 7401, continuous input")
    duration: float = parameter(40.0, "time", "duration of the sweep")


@dataclass(frozen=True)
class SineWithDwell:
    """Parameters of `sine_with_dwell`."""

    speed: float = parameter(SPEED, "velocity", "speed", "ISO 19365, test speed")
    lateral_acceleration: float = parameter(
        0.3 * G, "acceleration", "steady value of the unit A of steering", "ISO 19365"
    )
    frequency: float = parameter(0.7, "frequency", "frequency of the sine", "ISO 19365, steering input")
    dwell: float = parameter(0.5, "time", "pause at the second peak", "ISO 19365, steering input")
    factors: tuple[float, ...] = parameter(
        (1.5, 3.0, 4.5, 5.5, 6.5), "number", "amplitudes over the unit A", "ISO 19365: 1.5 A to 6.5 A"
    )
    final: float = parameter(
        math.radians(270), "angle", "least steering-wheel angle of the final run", "ISO 19365: max(6.5 A, 270 deg)"
    )
    largest: float = parameter(math.radians(300), "angle", "largest steering-wheel angle", "ISO 19365: 300 deg")
    turn: float = parameter(0.05, "length", "travel of a rack per turn of the steering wheel, where a rack steers")
    displacement: float = parameter(
        1.83, "length", "least lateral displacement", "ISO 19365: 1.83 m up to 3.5 t, 1.52 m above"
    )


@dataclass(frozen=True)
class LaneChange:
    """Parameters of `lane_change`."""

    speed: float = parameter(SPEED, "velocity", "entry speed, which the driver keeps", "ISO 3888-1, test method")


@dataclass(frozen=True)
class ObstacleAvoidance:
    """Parameters of `obstacle_avoidance`."""

    speed: float = parameter(
        50 / 3.6, "velocity", "before the course; the throttle is released in its first lane", "ISO 3888-2, test method"
    )
    slowest: float = parameter(30 / 3.6, "velocity", "lower end of the search of the highest entry speed")
    fastest: float = parameter(80 / 3.6, "velocity", "upper end of the search")
    resolution: float = parameter(1 / 3.6, "velocity", "width of the interval at which the search ends")


@dataclass(frozen=True)
class BrakingInATurn:
    """Parameters of `braking_in_a_turn`."""

    radius: float = parameter(100.0, "length", "radius of the circle", "ISO 7975, initial condition")
    lateral_acceleration: float = parameter(5.0, "acceleration", "of the circle before braking", "ISO 7975")
    pedal: float | None = parameter(None, "force", "braking force; by default the driver's")


@dataclass(frozen=True)
class StraightBraking:
    """Parameters of `straight_braking`."""

    speed: float = parameter(100 / 3.6, "velocity", "speed before braking", "ISO 21994, initial speed")
    pedal: float | None = parameter(None, "force", "braking force; by default the driver's")


@dataclass(frozen=True)
class Ride:
    """Parameters of `ride`."""

    speed: float = parameter(SPEED, "velocity", "speed")
    roughness: str = parameter("B", "class", "class of the road, A to H", "ISO 8608, road classes")
    duration: float = parameter(20.0, "time", "evaluated part of the run")


PAIRS = (("first", "last"), ("slowest", "fastest"))
"""Parameters of which the first is smaller than the second."""


def with_changes(given: Mapping[str, object], defaults: Mapping[str, Any]) -> dict[str, object]:
    """Return the parameters of tests with changes of a user.

    `given`: values by ``test.parameter``, or by ``parameter`` for each of the tests that has it; text may have a unit.
    `defaults`: parameters of the tests that run, by the name of the test. Raises InputError if there is no such test or
    parameter, or a value does not fit it.
    """
    found = dict(defaults)
    for path, value in sorted(given.items(), key=lambda item: "." in item[0]):
        test, dot, name = path.rpartition(".")
        if dot and test not in found:
            raise InputError(
                f"test parameter {path}: found the test '{test}'{did_you_mean(test, found)}, expected one that runs: {', '.join(found)}"
            )
        reached = [each for each in ([test] if dot else found) if name in names_of(found[each])]
        if not reached:
            known = list(dict.fromkeys(each for one in ([test] if dot else found) for each in names_of(found[one])))
            raise InputError(f"test parameter {path}: found no parameter '{name}'{instead_of(name, known)}")
        for each in reached:
            found[each] = replace(found[each], **{name: _value(f"{each}.{name}", value, found[each], name)})
    for test, one in found.items():
        for low, high in PAIRS:
            if hasattr(one, low) and getattr(one, low) >= getattr(one, high):
                raise InputError(
                    f"test parameters of {test}: found {low} {getattr(one, low):g} and {high} {getattr(one, high):g}, "
                    f"expected {low} below {high}"
                )
    return found


def names_of(parameters: Any) -> list[str]:
    """Return the names of a test's parameters."""
    return [each.name for each in fields(parameters)]


def _value(path: str, given: object, parameters: Any, name: str) -> object:
    dimension = next(each for each in fields(parameters) if each.name == name).metadata["dimension"]
    if dimension == "class":
        if given not in tuple("ABCDEFGH"):
            raise InputError(f"test parameter {path}: found '{given}', expected a class of road from A to H")
        return given
    if isinstance(getattr(parameters, name), tuple):
        listed = read_yaml(given, path) if isinstance(given, str) else given
        if not isinstance(listed, list | tuple) or not listed:
            raise InputError(f"test parameter {path}: found '{given}', expected a list of numbers such as [1.5, 3]")
        return tuple(positive(f"test parameter {path}", each, dimension) for each in listed)
    return positive(f"test parameter {path}", given, dimension)


def positive(name: str, given: object, dimension: str) -> float:
    """Return a number or text with a unit in SI units; raise an InputError if it is not above zero."""
    with prefixed(f"{name}: ", FormulaError):
        value = in_si(given, dimension)
    if value <= 0:
        raise InputError(f"{name}: found {given}, expected a value above zero")
    return value
