"""Angle unwrapping of a described start, as a drawing determines angles up to whole turns."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from ..compile.group import Group
from ..compile.system import INITIAL_COUNT, System
from ..elements.element import Joint
from ..elements.states.equation import AngleCounter
from ..reading.joint_name import JointName
from .dynamics import Dynamics

TURN = 2 * math.pi


def take_nearest_turns(dynamics: Dynamics, t: float, wanted: Callable[[str], bool] = lambda name: True) -> None:
    """Set the first angle of each equation of the wanted elements to the turn with the smallest violation.

    A drive from 200 degrees finds its joint at -160 degrees, one turn short. Without unwrapping, assembly would search
    for the turn in other poses.
    """
    groups = [group for group in dynamics.system.groups if group.record.n_counters and group.record.n_holonomic]
    if not groups:
        return
    state = dynamics.state
    first = np.concatenate([group.counters[:, 0] for group in groups])
    new = np.array([wanted(name) for group in groups for name in group.names])
    if not new.any():
        return
    kept = state.q[first]
    state.q[first] = INITIAL_COUNT
    state.count_anew(t)
    angle = state.q[first]
    left = _violations(dynamics, groups, t)
    state.q[first] = angle + TURN
    of_a_turn = _violations(dynamics, groups, t) - left
    squares = np.sum(of_a_turn**2, axis=1)
    turns = -np.sum(of_a_turn * left, axis=1) / np.where(squares > 0, squares, np.inf)
    state.q[first] = np.where(new, angle + TURN * np.round(turns), kept)
    of_drives = {channel: place for channel, place, counter in counted_coordinates(dynamics.system) if not counter}
    for channel, place, counter in counted_coordinates(dynamics.system):
        if counter and channel in of_drives:
            state.q[place] = state.q[of_drives[channel]]


def counted_coordinates(system: System) -> Iterator[tuple[str, int, bool]]:
    """Yield the joint angles that a request or a drive counts, their counters' places in q, and True for a request."""
    of_joints = [group for group in system.groups if issubclass(group.kind.element, Joint)]
    joints = {name: joint for group in of_joints for name, joint in zip(group.names, group.elements, strict=True)}
    for group in system.groups:
        if group.record.n_counters == 1:
            for name, element, (place,) in zip(group.names, group.elements, group.counters, strict=True):
                if isinstance(element, AngleCounter):
                    yield name, int(place), True
                elif len(named := [joint for _, joint in element.parts(JointName)]) == 1:
                    coordinate = named[0].coordinate_of(joints[named[0].joint])
                    if coordinate is not None:
                        yield f"{named[0].joint}.{coordinate}", int(place), False


def _violations(dynamics: Dynamics, groups: list[Group], t: float) -> np.ndarray:
    """Return C of the elements of some groups, one element per row, padded with zeros."""
    dynamics.state.evaluate("position", t)
    C = dynamics.state.vector("position", "C")
    widest = max(group.record.n_equations for group in groups)
    rows = []
    for group in groups:
        n = group.record.n_equations
        own = C[group.first_row : group.first_row + n * group.count].reshape(group.count, n)
        rows.append(np.pad(own, ((0, 0), (0, widest - n))))
    return np.concatenate(rows)
