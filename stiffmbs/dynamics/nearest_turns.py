"""Angle unwrapping of a described start, as a drawing determines angles up to whole turns."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..compile.group import Group
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
    state.q[first] = 0.0
    left = _violations(dynamics, groups, t)
    state.q[first] = TURN
    of_a_turn = _violations(dynamics, groups, t) - left
    squares = np.sum(of_a_turn**2, axis=1)
    turns = -np.sum(of_a_turn * left, axis=1) / np.where(squares > 0, squares, np.inf)
    state.q[first] = np.where(new, TURN * np.round(turns), kept)


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
