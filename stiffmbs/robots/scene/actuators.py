"""Actuators and tendons of a robot as inputs and forces of its scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ...describe.spatial.number_format import plain
from ..robot import Robot, Transmission
from .joints import along_axis
from .mechanism import Hold, Mechanism


@dataclass(frozen=True)
class Actuators:
    """The sections of the scene that actuators fill: inputs, states behind filters, named formulas, and forces."""

    inputs: dict[str, Any] = field(default_factory=dict)
    states: dict[str, Any] = field(default_factory=dict)
    variables: dict[str, Any] = field(default_factory=dict)
    forces: dict[str, Any] = field(default_factory=dict)


def actuators(robot: Robot, mechanism: Mechanism) -> Actuators:
    """What all transmissions of a robot put into its scene."""
    found = Actuators()
    for transmission in robot.transmissions:
        holds = [
            (mechanism.holds[joint], gear) for joint, gear in transmission.gears.items() if joint in mechanism.holds
        ]
        if holds:
            _add(found, mechanism, transmission, holds)
    return found


def _add(found: Actuators, mechanism: Mechanism, transmission: Transmission, holds: list[tuple[Hold, float]]) -> None:
    name = mechanism.names.take(f"{transmission.name}_force")
    length = " + ".join(f"{plain(gear)}*{hold.coordinate}" for hold, gear in holds)
    rate = " + ".join(f"{plain(gear)}*{hold.rate}" for hold, gear in holds)
    force = _affine(transmission.bias, length, rate)
    if transmission.gain is not None:
        u = _activation(found, mechanism, transmission)
        gain = _affine(transmission.gain, length, rate)
        force = f"{_times(gain, u)} + {force}" if force != "0" else _times(gain, u)
    found.variables[name] = _within(force, transmission.force)
    for hold, gear in holds:
        element = mechanism.names.take(
            f"{transmission.name}_{hold.name}" if len(holds) > 1 else f"{transmission.name}_drive"
        )
        found.forces[element] = along_axis(hold, _times(repr(plain(gear)), name))


def _activation(found: Actuators, mechanism: Mechanism, transmission: Transmission) -> str:
    """The input of an actuator, or the state of the filter or integrator behind it."""
    name = mechanism.names.take(f"{transmission.name}_input")
    found.inputs[name] = 0
    u = _within(name, transmission.control)
    if transmission.lag is None:
        return u
    state = mechanism.names.take(f"{transmission.name}_activation")
    found.states[state] = {"rate": f"({u} - {state})/{plain(transmission.lag)}" if transmission.lag else u}
    return state


def _affine(coefficients: tuple[float, ...], length: str, rate: str) -> str:
    constant, by_length, by_rate = coefficients
    terms = [repr(plain(constant))] if constant else []
    terms += [f"{plain(c)}*({x})" for c, x in ((by_length, length), (by_rate, rate)) if c]
    return " + ".join(terms) or "0"


def _times(factor: str, text: str) -> str:
    if factor == "1":
        return text
    return f"({factor})*{text}" if " " in factor else f"{factor}*{text}"


def _within(text: str, bounds: tuple[float, float] | None) -> str:
    return text if bounds is None else f"min(max({text}, {plain(bounds[0])}), {plain(bounds[1])})"
