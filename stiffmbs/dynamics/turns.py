"""Full turns of angles in space at the start: those of drives, and of every element that reads the same angle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..compile.formula_shape import Shape
from ..compile.group import Group
from ..compile.system import System
from ..elements.element import Element, Joint
from ..elements.requests.output import CONTINUOUS_ANGLES
from ..elements.turns import INITIAL_COUNT, TURN
from ..reading.formula.formula import Formula
from .dynamics import Dynamics


@dataclass(frozen=True)
class CountedAngle:
    """Angle whose turns an element counts.

    `place`: index of its counter in q. `element`: name of the element. `number`: of the counter within the element.
    `channel`: the coordinate of a joint, such as ``hinge.angle``; None for other angles. `measure`: the angle between
    markers that a formula reads, ``az(bar.end, ground)``; empty for other angles. `constrained`: true if the element's
    position equations contain the angle. `driven`: true if the element is a drive.
    """

    place: int
    element: str
    number: int
    channel: str | None
    measure: str
    constrained: bool
    driven: bool


def _is_driven(group: Group) -> bool:
    from ..elements.joints.drive import Drive

    return issubclass(group.kind.element, Drive)


def counted_angles(system: System) -> Iterator[CountedAngle]:
    """Yield the angles whose turns are counted, by element."""
    joint_at = {
        group.first_row + k * group.record.n_equations: name
        for group in system.groups
        if issubclass(group.kind.element, Joint)
        for k, name in enumerate(group.names)
    }
    for group in system.groups:
        first = 2 * group.kind.n_bodies + 1
        if not group.record.n_counters:
            continue
        for name, element, index, places in zip(group.names, group.elements, group.index, group.counters, strict=True):
            measures = _measures(group, element)
            for k, (of, place) in enumerate(zip(group.record.counted, places, strict=True)):
                measure = "" if of else next(measures, "")
                channel = f"{joint_at[index[first + of[0]]]}.{of[1]}" if of else _own_angle(group, name)
                constrained, driven = group.record.n_holonomic > 0, _is_driven(group)
                yield CountedAngle(int(place), name, k, channel, measure, constrained, driven)


def _measures(group: Group, element: Element) -> Iterator[str]:
    """Yield the angles between markers in the formulas of an element, in the order of the counters of no joint.

    They come before the angles of the element's own equations, but after those of joints that it refers to. Yield none if the
    formulas are not those of the kind alone, as they contain outputs of states.
    """
    of_formulas = [
        dict.fromkeys((name, markers) for name, markers in formula.measures() if name in CONTINUOUS_ANGLES)
        for _, formula in element.parts(Formula)
    ]
    found = [measure for measures in of_formulas for measure in measures]
    of_kind = [name for name in _measured(group.kind.fields) if name in CONTINUOUS_ANGLES]
    others = group.record.counted.count(None) - len(found)
    if [name for name, _ in found] == of_kind and not (group.kind.n_joints and others):
        yield from (f"{name}({', '.join(marker.label for marker in markers)})" for name, markers in found)


def _measured(fields: Iterable[tuple[str, Shape]]) -> Iterator[str]:
    """Yield the measures in formulas of a kind."""
    for _, shape in fields:
        match shape:
            case ("formula", _, _, measures, *_):
                yield from (name for name, _ in measures)
            case ("several", parts):
                yield from _measured(("", part) for part in parts)


def take_nearest_turns(dynamics: Dynamics, t: float, wanted: Callable[[str], bool] = lambda name: True) -> None:
    """Set the counters of the wanted elements to the turns in which position equations have the smallest violation.

    A drive from 200 degrees finds its joint at -160 degrees, one turn short. Without unwrapping, assembly would search
    for the turn in other poses. Drives come first, then relations of several angles. All elements that read the same
    coordinate of a joint, and requests for it, take the same turn. A wanted drive selects it, in place of a known turn.
    """
    angles = list(counted_angles(dynamics.system))
    q = dynamics.state.q
    free = {angle.place: angle for angle in angles if wanted(angle.element) or angle.element == angle.channel}
    known: dict[Any, float] = {
        angle.channel: q[angle.place] for angle in angles if angle.channel and angle.place not in free
    }
    known |= dynamics.system.start_angles
    q[[place for place, angle in free.items() if angle.constrained]] = INITIAL_COUNT
    prescribed = {angle.channel for angle in free.values() if angle.driven and angle.constrained}
    known = {channel: angle for channel, angle in known.items() if channel not in prescribed}
    described: dict[Any, float] = dict(dynamics.system.described_angles)
    while True:
        decided = {place: known[angle.channel] for place, angle in free.items() if angle.channel in known}
        for place, turned in decided.items():
            q[place] = turned
            del free[place]
        undecided: dict[str, list[CountedAngle]] = {}
        for angle in free.values():
            if angle.constrained:
                undecided.setdefault(angle.element, []).append(angle)
        if not undecided and not described:
            break
        driven = [found for found in undecided.values() if len(found) == 1]
        if described and not driven:
            known, described = described | known, {}
            continue
        chosen = driven or [min(undecided.values(), key=len)]
        _take_nearest_turns(dynamics, t, [first for first, *_ in chosen])
        for angle in (angle for found in chosen for angle in found):
            del free[angle.place]
            known |= {angle.channel: q[angle.place]} if angle.channel else {}


def _own_angle(group: Group, name: str) -> str | None:
    """Return the coordinate of a joint that counts its own angle, such as a screw."""
    if not issubclass(group.kind.element, Joint) or group.record.n_counters != 1:
        return None
    own = [coordinate for coordinate in group.kind.element.free_coordinates() if coordinate.startswith("angle")]
    return f"{name}.{own[0]}" if len(own) == 1 else None


def _take_nearest_turns(dynamics: Dynamics, t: float, angles: Sequence[CountedAngle]) -> None:
    """Set the counters of angles of different elements, each to the turn with the smallest violation of its element."""
    state, places = dynamics.state, [angle.place for angle in angles]
    of_element = {angle.element: k for k, angle in enumerate(angles)}
    element = np.array([of_element.get(name, len(angles)) for name, _ in dynamics.system.equations])

    def violations() -> np.ndarray:
        state.evaluate("position", t)
        return state.vector("position", "C")

    def sums(products: np.ndarray) -> np.ndarray:
        return np.bincount(element, products, len(angles) + 1)[:-1]

    state.restart_counters(t)
    within = state.q[places]
    left = violations()
    state.q[places] = within + TURN
    of_a_turn = violations() - left
    squares = sums(of_a_turn**2)
    state.q[places] = within - TURN * np.round(sums(of_a_turn * left) / np.where(squares > 0, squares, np.inf))
