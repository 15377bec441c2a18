"""Independent mechanisms of a system: bodies that no joint, force or state connects, except through the ground."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..compile.group import Group
from ..compile.system import System

NO_MECHANISM = np.iinfo(np.int64).max


def mechanisms(system: System) -> list[np.ndarray]:
    """Return the body numbers of each mechanism, in the order of their first bodies."""
    if len(system.bodies) == 1:
        return [np.zeros(1, dtype=np.int64)]
    bodies = _first_bodies(system)[: len(system.bodies)]
    return [np.flatnonzero(bodies == first) for first in np.flatnonzero(bodies == np.arange(len(bodies)))]


def _first_bodies(system: System) -> np.ndarray:
    """Return the first body of the mechanism of each body, the ground and each state; body 0 if there is none."""
    count = len(system.bodies) + 1 + len(system.states)
    label = np.arange(count)  # least number of a part known to be connected
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
    return np.where(label < len(system.bodies), label, 0)


def counters_of(system: System) -> dict[tuple[str, int], int]:
    """Return the coordinates of rotation counters by element and number within it."""
    return {
        (name, k): int(at)
        for group in system.groups
        for name, places in zip(group.names, group.counters, strict=True)
        for k, at in enumerate(places)
    }


def trailing_coordinates(system: System) -> dict[tuple[str, int | None], int]:
    """Return the coordinates of rotation counters and states by name; a state has no number."""
    return {**counters_of(system)} | {(name, None): system.first_state + k for k, name in enumerate(system.states)}


def _parts(system: System, group: Group) -> np.ndarray:
    """Return the bodies, ground and states of each element, numbered in this order, shape (count, parts)."""
    return np.hstack([group.bodies, group.states - system.first_state + len(system.bodies) + 1])


def _pairs(system: System, group: Group) -> np.ndarray:
    """Return pairs of the first body or state of each element and its others, without the ground, shape (pairs, 2)."""
    parts, ground = _parts(system, group), len(system.bodies)
    if parts.shape[1] < 2:
        return np.empty((0, 2), dtype=np.int64)
    least = np.where(parts == ground, NO_MECHANISM, parts).min(axis=1)
    pairs = np.column_stack([np.repeat(least, parts.shape[1]), parts.ravel()])
    return pairs[pairs[:, 1] != ground]


def part_of(system: System, bodies: np.ndarray) -> System:
    """Return the system of one mechanism; its elements keep the numbers of the whole system.

    `bodies`: its bodies, which are connected with no others.
    """
    own_states = np.flatnonzero(np.isin(_first_bodies(system)[len(system.bodies) + 1 :], bodies))
    place = np.full(len(system.bodies) + 1, -1)
    place[bodies], place[-1] = np.arange(len(bodies)), len(bodies)
    present = np.zeros(len(system.bodies) + 1 + len(system.states), dtype=bool)
    present[bodies] = present[len(system.bodies) + 1 + own_states] = True
    chosen = [(group, present[_parts(system, group)].any(axis=1)) for group in system.groups]
    rows = np.concatenate(
        [np.empty(0, dtype=np.int64), *(_rows(group, inside) for group, inside in chosen if inside.any())]
    )
    new_row = np.full(system.n_c, -1)
    new_row[rows] = np.arange(len(rows))
    of_body = system.of_body
    q, u = ((width * bodies[:, None] + np.arange(width)).ravel() for width in (of_body.n_q, of_body.n_u))
    counters = [group.counters[inside].ravel() for group, inside in chosen]
    trailing = np.concatenate([np.empty(0, dtype=np.int64), *counters, system.first_state + own_states])
    new_trailing = np.full(system.n_q, -1)
    new_trailing[trailing] = len(q) + np.arange(len(trailing))
    return replace(
        system,
        bodies=tuple(system.bodies[k] for k in bodies),
        states=tuple(system.states[k] for k in own_states), state_scales=system.state_scales[own_states],
        algebraic=system.algebraic[own_states], sampling=system.sampling[own_states],
        q=system.q[np.append(q, trailing)], u=system.u[u], open_rates=system.open_rates[u], mass=system.mass[u], followed=system.followed[u], principal_axes=system.principal_axes[bodies],
        groups=tuple(_part(group, inside, place, new_row, new_trailing) for group, inside in chosen if inside.any()),
        equations=tuple(system.equations[row] for row in rows),
        holonomic=system.holonomic[rows], active=system.active[rows],
    )  # fmt: skip


def _rows(group: Group, inside: np.ndarray) -> np.ndarray:
    count = group.record.n_equations
    return (group.first_row + count * np.flatnonzero(inside)[:, None] + np.arange(count)).ravel()


def _part(group: Group, inside: np.ndarray, place: np.ndarray, new_row: np.ndarray, new_trailing: np.ndarray) -> Group:
    index, end = group.index[inside].copy(), 2 * group.kind.n_bodies
    numbers = place[group.bodies[inside]]
    joints, ground = end + 1 + group.kind.n_joints, group.of_body.n_q * place[-1] + np.sum(new_trailing >= 0)
    index[:, 0:end:2] = np.where(numbers == place[-1], ground, group.of_body.n_q * numbers)
    index[:, 1:end:2] = group.of_body.n_u * numbers
    index[:, end + 1 : joints] = new_row[index[:, end + 1 : joints]]
    index[:, joints:] = new_trailing[index[:, joints:]]
    rows = _rows(group, inside)
    return replace(
        group,
        names=tuple(name for name, kept in zip(group.names, inside, strict=True) if kept),
        elements=[element for element, kept in zip(group.elements, inside, strict=True) if kept],
        index=index,
        first_row=int(new_row[rows[0]]) if len(rows) else 0,
    )
