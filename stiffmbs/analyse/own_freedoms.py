"""Freedoms of single bodies between others: a rod on two balls turns about itself, and nothing else moves with it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..compile.system import System
from ..solve.mechanics import Mechanics
from .unproven import by_functions

FREE = 1e-8
"""Singular value, in parts of the largest, of a motion that no joint hinders."""
PERTURBATION = 0.1
"""Size of a move (sizes of the system, rad) to a second pose: what is free at one alone is a matter of that pose."""
TURNS = 1e-6
"""Part of a motion that is rounding."""


@dataclass(frozen=True)
class OwnFreedom:
    """A motion of one body that moves no other.

    Attributes
    ----------
    body : str
    joints : tuple of str
        That hold it between others.
    motion : str
        ``turn``, ``slide`` or, where it is more than one of these, ``move``.
    """

    body: str
    joints: tuple[str, ...]
    motion: str


def own_freedoms(mechanics: Mechanics, t: float) -> list[OwnFreedom]:
    """The bodies that can move by themselves although joints hold them between others.

    Parameters
    ----------
    mechanics : Mechanics
        At an assembled pose; left as it is.
    t : float
        s.
    """
    system, state = mechanics.system, mechanics.state
    between = dict(_between_others(system))
    for body in _held_by_functions(system):  # a formula that is flat here may hold the body elsewhere
        between.pop(body, None)
    found = _free(mechanics, between, t)
    if not found:
        return []
    q = state.q.copy()
    step = PERTURBATION * np.random.default_rng(1).uniform(-1, 1, system.n_u) * system.per_velocity(system.size, 1.0)
    state.q[:] = system.of_body.moved(q, step)
    also = _free(mechanics, between, t) if mechanics.assemble(t) >= 0 else {}
    state.q[:] = q
    return [
        OwnFreedom(system.bodies[body], between[body], motion)
        for body, motion in found.items()
        if motion == also.get(body)
    ]


def _between_others(system: System) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Each body that joints hold against more than one other (the ground is one), with these joints."""
    around: dict[int, dict[str, set[int]]] = {}
    for group in system.groups:
        for name, bodies in zip(group.names, group.bodies.tolist(), strict=True) if group.record.n_equations else ():
            for body in set(bodies) - {len(system.bodies)}:
                around.setdefault(body, {})[name] = set(bodies) - {body}
    for body, joints in around.items():
        if len(set[int]().union(*joints.values())) > 1:
            yield body, tuple(joints)


def _held_by_functions(system: System) -> set[int]:
    """The bodies in constraints with formulas or tables."""
    J = system.term("motion", "J")
    return set((J.column[by_functions(system)[J.row]] // system.of_body.n_u).tolist())


def _free(mechanics: Mechanics, bodies: dict[int, tuple[str, ...]], t: float) -> dict[int, str]:
    """Of some bodies those that no joint hinders from a motion of their own, and that motion."""
    system, state = mechanics.system, mechanics.state
    state.evaluate("motion", t)
    term, width = system.term("motion", "J"), system.of_body.n_u
    value = state.values["motion"][term.source] / system.per_velocity(1.0, system.size)[term.column]
    order = np.argsort(term.column // width, kind="stable")
    ends = np.searchsorted(term.column[order] // width, np.arange(len(system.bodies) + 1))
    found = {}
    for body in bodies:
        own = order[ends[body] : ends[body + 1]]
        rows, row = np.unique(term.row[own], return_inverse=True)
        J = np.zeros((max(len(rows), width), width))
        np.add.at(J, (row, term.column[own] % width), value[own])
        if not np.all(np.isfinite(J)):
            continue
        _, values, ways = np.linalg.svd(J)
        free = ways[values <= FREE * values[0]]
        if len(free):
            found[body] = _motion(free, system.of_body.linear)
    return found


def _motion(ways: np.ndarray, linear: int) -> str:
    """What motions (rows of velocities) amount to, in a word."""
    if len(ways) > 1:
        return "move"
    turning = ways[0, linear:]
    if np.linalg.norm(turning) < TURNS:
        return "slide"
    return "turn"
