"""Conversion of actuators and tendons to inputs and forces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from ...elements.spatial.number_format import plain
from ...reading.files.yaml_text import Content
from ..robot import Robot, RobotFault, Segment, Transmission
from .joints import along_axis
from .mechanism import Hold, Mechanism


@dataclass(frozen=True)
class Actuators:
    """Scene sections of actuators: inputs, filter states, named formulas, and forces."""

    inputs: Content = field(default_factory=dict)
    states: Content = field(default_factory=dict)
    variables: Content = field(default_factory=dict)
    forces: Content = field(default_factory=dict)


def actuators(robot: Robot, mechanism: Mechanism) -> Actuators:
    """Return the scene sections of all transmissions of a robot."""
    found = Actuators()
    limited: dict[str, list[str]] = {}
    named = []
    for transmission in robot.transmissions:
        holds = [(mechanism.holds[x], gear) for x, gear in transmission.gears.items() if x in mechanism.holds]
        lines = [_line(mechanism, transmission, k, part) for k, part in enumerate(transmission.segments, start=1)]
        bounded = [hold.name for hold in mechanism.holds.values() if hold.joint.effort is not None]
        if lines and bounded and transmission.gain is not None:
            raise RobotFault(
                f"actuator {transmission.name}: found a tendon through space and bounds of the force of actuators on "
                f"{', '.join(bounded)}, expected one of them"
            )
        if holds or lines:
            named.append((transmission, holds, lines, _force(found, mechanism, transmission, holds, lines)))
    for transmission, holds, lines, name in named:
        along = [other for t, *_, other in named if transmission.total and t.tendon == transmission.tendon]
        force = _of_total(transmission, name, along)
        found.forces.update(_pulls(mechanism, transmission, lines, force))
        for hold, gear in holds:
            term = _times(repr(plain(gear)), force)
            if hold.joint.effort is not None and transmission.gain is not None:
                limited.setdefault(hold.joint.name, []).append(term)
                continue
            element = mechanism.names.take(
                f"{transmission.name}_{hold.name}" if len(holds) > 1 else f"{transmission.name}_drive"
            )
            found.forces[element] = along_axis(hold, term)
    for joint, terms in limited.items():
        hold = mechanism.holds[joint]
        element = mechanism.names.take(f"{hold.name}_drive")
        found.forces[element] = along_axis(hold, _within(" + ".join(terms), hold.joint.effort))
    return found


Line = tuple[str, str, float]
"""Segment of a tendon: markers at its ends, and its factor."""


def _line(mechanism: Mechanism, transmission: Transmission, k: int, segment: Segment) -> Line:
    """Add markers at the ends of a segment of a tendon."""
    names = (mechanism.names.take(f"{transmission.name}_{k}{end}") for end in "ij")
    ends = (segment.link, segment.point), (segment.other, segment.other_point)
    i, j = (mechanism.mark(link, name, point) for (link, point), name in zip(ends, names, strict=True))
    return i, j, segment.factor


def _pulls(
    mechanism: Mechanism, transmission: Transmission, lines: list[Line], force: str
) -> Iterator[tuple[str, object]]:
    """Yield the forces along the segments of a tendon that connect two bodies."""
    for i, j, factor in lines:
        if i.partition(".")[0] != j.partition(".")[0]:
            law = _times(repr(plain(factor)), force)
            yield (
                mechanism.names.take(f"{transmission.name}_pull"),
                {"type": "line_force", "i": i, "j": j, "force": law},
            )


def _force(
    found: Actuators,
    mechanism: Mechanism,
    transmission: Transmission,
    holds: list[tuple[Hold, float]],
    lines: list[Line],
) -> str:
    """Add the formula of a transmission's force and return its name; a bounded total of its tendon is applied later."""
    name = mechanism.names.take(f"{transmission.name}_force")
    parts = [(gear, hold.coordinate, hold.rate) for hold, gear in holds]
    parts += [(factor, f"dm({i}, {j})", f"vr({i}, {j})") for i, j, factor in lines]
    length, rate = (" + ".join(f"{plain(part[0])}*{part[k]}" for part in parts) for k in (1, 2))
    force = _affine(transmission.bias, length, rate)
    if transmission.gain is not None:
        u = _activation(found, mechanism, transmission)
        gain = _affine(transmission.gain, length, rate)
        force = f"{_times(gain, u)} + {force}" if force != "0" else _times(gain, u)
    found.variables[name] = force if transmission.total else _within(force, transmission.force)
    return name


def _of_total(transmission: Transmission, name: str, along: list[str]) -> str:
    """Return the force of an actuator; MuJoCo limits the total force on a tendon before the force of each actuator.

    Raises RobotFault if the bounds of the total force of several actuators do not enclose zero.
    """
    if transmission.total is None:
        return name
    if len(along) == 1:
        return _within(_within(name, transmission.total), transmission.force)
    low, high = transmission.total
    if not low < 0 < high:
        raise RobotFault(
            f"tendon {transmission.tendon}: found the bounds {low:g} and {high:g} of the force of {len(along)} actuators, "
            "expected one below and one above zero"
        )
    total = f"({' + '.join(along)})"
    return _within(f"{name}/max(1, {total}/{plain(high)}, {total}/({plain(low)}))", transmission.force)


def _activation(found: Actuators, mechanism: Mechanism, transmission: Transmission) -> str:
    """Return the input of an actuator, or the state of its filter or integrator."""
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
