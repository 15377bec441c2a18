"""Independent mechanisms of a system: bodies that no joint and no force connects, but for the ground."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..compile.group import Group
from ..compile.system import System


def mechanisms(system: System) -> list[np.ndarray]:
    """The numbers of the bodies of each mechanism, in the order of their first bodies."""
    if len(system.bodies) == 1:
        return [np.zeros(1, dtype=np.int64)]
    label = np.arange(len(system.bodies) + 1)  # of each body the least number that it is known to be connected with
    pairs = np.concatenate([np.empty((0, 2), dtype=np.int64), *(_pairs(system, group) for group in system.groups)])
    while True:
        least = np.minimum(label[pairs[:, 0]], label[pairs[:, 1]])
        lower = label.copy()
        np.minimum.at(lower, pairs[:, 0], least)
        np.minimum.at(lower, pairs[:, 1], least)
        lower = lower[lower]
        if np.array_equal(lower, label):
            break
        label = lower
    bodies = label[: len(system.bodies)]
    return [np.flatnonzero(bodies == first) for first in np.flatnonzero(bodies == np.arange(len(bodies)))]


def counters_of(system: System) -> dict[tuple[str, int], int]:
    """The coordinates that count turns, by element and number among its own."""
    return {
        (name, k): int(at)
        for group in system.groups
        for name, places in zip(group.names, group.counters, strict=True)
        for k, at in enumerate(places)
    }


def _pairs(system: System, group: Group) -> np.ndarray:
    """Each element's first body with each of its others, the ground left out, shape (pairs, 2)."""
    if group.kind.n_bodies < 2:
        return np.empty((0, 2), dtype=np.int64)
    bodies = group.bodies
    first = np.repeat(bodies.min(axis=1), group.kind.n_bodies)
    pairs = np.column_stack([first, bodies.ravel()])
    return pairs[pairs[:, 1] < len(system.bodies)]  # the ground has the greatest number


def part_of(system: System, bodies: np.ndarray) -> System:
    """The system of one mechanism; its elements' numbers stay those of the whole.

    Parameters
    ----------
    bodies : ndarray of int
        Its bodies, none connected with any other.
    """
    place = np.full(len(system.bodies) + 1, -1)
    place[bodies], place[-1] = np.arange(len(bodies)), len(bodies)
    chosen = [(group, _inside(group, place)) for group in system.groups]
    rows = np.concatenate(
        [np.empty(0, dtype=np.int64), *(_rows(group, inside) for group, inside in chosen if inside.any())]
    )
    new_row = np.full(system.n_c, -1)
    new_row[rows] = np.arange(len(rows))
    of_body = system.of_body
    q, u = ((width * bodies[:, None] + np.arange(width)).ravel() for width in (of_body.n_q, of_body.n_u))
    counters = np.concatenate([np.empty(0, dtype=np.int64), *(g.counters[inside].ravel() for g, inside in chosen)])
    new_counter = np.full(system.n_q, -1)
    new_counter[counters] = len(q) + np.arange(len(counters))
    return replace(
        system,
        bodies=tuple(system.bodies[k] for k in bodies),
        q=system.q[np.append(q, counters)], u=system.u[u], open_rates=system.open_rates[u], mass=system.mass[u], principal_axes=system.principal_axes[bodies],
        groups=tuple(_part(group, inside, place, new_row, new_counter) for group, inside in chosen if inside.any()),
        equations=tuple(system.equations[row] for row in rows),
        holonomic=system.holonomic[rows], active=system.active[rows],
    )  # fmt: skip


def _inside(group: Group, place: np.ndarray) -> np.ndarray:
    """Which elements act on the bodies that have a place: the ground alone is none of them."""
    on = place[group.bodies]
    return ((on >= 0) & (on < place[-1])).any(axis=1)


def _rows(group: Group, inside: np.ndarray) -> np.ndarray:
    """The equations of the elements inside."""
    count = group.record.n_equations
    return (group.first_row + count * np.flatnonzero(inside)[:, None] + np.arange(count)).ravel()


def _part(group: Group, inside: np.ndarray, place: np.ndarray, new_row: np.ndarray, new_counter: np.ndarray) -> Group:
    index, end = group.index[inside].copy(), 2 * group.kind.n_bodies
    numbers = place[group.bodies[inside]]
    joints, ground = end + 1 + group.kind.n_joints, group.of_body.n_q * place[-1] + np.sum(new_counter >= 0)
    index[:, 0:end:2] = np.where(numbers == place[-1], ground, group.of_body.n_q * numbers)
    index[:, 1:end:2] = group.of_body.n_u * numbers
    index[:, end + 1 : joints] = new_row[index[:, end + 1 : joints]]
    index[:, joints:] = new_counter[index[:, joints:]]
    rows = _rows(group, inside)
    return replace(
        group,
        names=tuple(name for name, kept in zip(group.names, inside, strict=True) if kept),
        elements=[element for element, kept in zip(group.elements, inside, strict=True) if kept],
        index=index,
        first_row=int(new_row[rows[0]]) if len(rows) else 0,
    )
