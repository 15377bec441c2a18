"""Block system of accelerations with u' eliminated, unless bodies have many joints each."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate, combinations
from typing import NamedTuple

import numpy as np

from ...compile.equations import ABSENT, Equations
from ...compile.machine.layout import Table, arrays_of, fill, packed
from ...compile.machine.object_code import SHORT
from ...compile.machine.routines import together
from ...compile.state import State
from ...compile.system import System
from ...sparse.minimum_degree import minimum_degree
from ..native.layouts import ELIMINATED
from ..native.parameters import ELIMINATION
from ..saddle_point import ACCELERATIONS
from .joint_blocks import Joints, block_lists
from .native.layouts import BLOCK_ELIMINATION, PIN_ELIMINATION, Pin, PinProduct

ATTEMPT, FACTOR, MOVE = together(
    "stiffmbs.dynamics.elimination.native.eliminated",
    SHORT,
    attempt="int32(float64, float64*, int64*)",
    factor="int32(float64, int64*, int64*)",
    move="int32(float64*, int64*)",
)


class Eliminated:
    """Schur complement J M^-1 J^T lam = J M^-1 f - gamma, then u' = M^-1 (f - J^T lam), for compiled code.

    The matrix is symmetric and positive definite, so its factors need no pivoting and keep their pattern.  It is
    factored by pins for planar models with revolute joints alone, else by dense blocks. `updates`: multiplications of
    the LU of the whole system.

    - `serves`: true if the mass matrix is diagonal, no force depends on multipliers or algebraic states, and the
      elimination is less expensive.
    - `pivots_tell`: true if it serves, and no inertia is so small that pivots do not show the distance from a singular
      pose.
    - `multiplications`: multiplications of the elimination.
    - `table`: addresses (`stiffmbs.dynamics.native.layouts.ELIMINATED`); zeros if it does not serve.
    """

    def __init__(self, state: State, updates: int) -> None:
        system = state.system
        jacobian = system.term("acceleration", "J")
        solved = Equations(ACCELERATIONS, system).at["lam"] != ABSENT
        kept = np.flatnonzero(solved[jacobian.row])
        joint_of = np.searchsorted(system.joint_start, np.arange(system.n_c), side="right") - 1
        bodies = _bodies(joint_of[jacobian.row[kept]], jacobian.column[kept] // system.of_body.n_u)
        rows = [np.flatnonzero(solved & (joint_of == joint)) for joint in range(len(system.joint_start) - 1)]
        order = [joint for joint in _balanced_order(bodies, len(rows)) if len(rows[joint])]
        joints = Joints([rows[joint] for joint in order], [bodies.get(joint, []) for joint in order])
        hanging = len(system.term("acceleration", "f_lam").source) + len(system.term("acceleration", "inertia").source)
        self.multiplications = joints.updates
        few = self.multiplications <= ELIMINATION.most_multiplications * updates
        self.serves = not hanging and not system.algebraic.any() and few
        resisting = np.sqrt(system.mass) / system.per_velocity(1.0, system.size)
        self.pivots_tell = self.serves and bool(
            resisting.max(initial=0.0) < ELIMINATION.even * resisting.min(initial=np.inf)
        )
        self.table = Table(ELIMINATED)
        self._cells = self.table.view(ELIMINATED.cells)[0]
        if self.serves:
            of_pins = pin_lists(joints, system, kept) if system.of_body.dimensions == 2 else None
            layout = PIN_ELIMINATION if of_pins else BLOCK_ELIMINATION
            self._lists = of_pins or block_lists(joints, system, kept)
            force, gamma = (system.term("acceleration", name) for name in ("f", "gamma"))
            own = np.flatnonzero(solved[gamma.row])
            scale = self._lists.get("pivot_scale", np.zeros(0))
            self._largest_scale = np.zeros_like(scale)
            arrays = {
                "f_source": force.source, "f_row": force.row, "scale": 1.0 / np.sqrt(system.mass), "a": np.zeros(system.n_u + 3),
                "q_before": np.zeros(system.n_q), "u_before": np.zeros(system.n_u),
                "left": np.zeros(system.n_c), "sizes": np.zeros(system.n_c),
                "j_source": jacobian.source[kept], "j_row": jacobian.row[kept], "j_column": jacobian.column[kept],
                "gamma_source": gamma.source[own], "gamma_row": gamma.row[own],
                "pivot_scale": scale, "largest_scale": self._largest_scale,
            }  # fmt: skip
            numbers = {
                "n_scales": len(self._largest_scale),
                "n_u": system.n_u,
                "n_f": len(force.source),
                "n_j": len(kept),
                "n_gamma": len(own),
                "by_pins": of_pins is not None,
                "trees": _are_trees(joints.bodies),
            }
            self._arrays = {
                **arrays_of(ELIMINATED, arrays),
                "state": state.table,
                "lists": packed(layout, self._lists),
                "kept": 1.0,
                "log_mass": float(np.log(system.mass).sum()),
                "least": ELIMINATION.least_residual * min(1.0, system.size),
                **numbers,
            }
            fill(self.table, self._arrays)

    def within_reach(self) -> np.ndarray:
        """Return the table, with the addresses of its routines for compiled code without its own references to them."""
        for name, routine in (("attempt", ATTEMPT), ("factor", FACTOR), ("move", MOVE)):
            self.table.link(name, routine)
        return self.table

    def forget(self) -> None:
        """Reset the largest pivots, so that rounding in a run does not depend on earlier runs."""
        self._cells["most_kept"] = 0.0
        if self.serves:
            self._largest_scale[:] = 0.0


def _bodies(joint: np.ndarray, body: np.ndarray) -> dict[int, list[int]]:
    found: dict[int, set[int]] = {}
    for one, place in zip(joint.tolist(), body.tolist(), strict=True):
        found.setdefault(one, set()).add(place)
    return {one: sorted(places) for one, places in found.items()}


def _are_trees(bodies_of: list[list[int]]) -> bool:
    """Return True if no joint closes a loop of bodies or of bodies and ground."""
    parent: dict[int, int] = {}

    def root(body: int) -> int:
        while parent.setdefault(body, body) != body:
            parent[body] = parent[parent[body]]
            body = parent[body]
        return body

    for bodies in bodies_of:
        first, *others = bodies if len(bodies) > 1 else [ABSENT, *bodies]
        for other in others:
            if root(first) == root(other):
                return False
            parent[root(other)] = root(first)
    return True


def _balanced_order(bodies: dict[int, list[int]], count: int) -> list[int]:
    """Return an order of the joints with little fill-in: minimum degree on joints that share a body."""
    around: list[set[int]] = [set() for _ in range(count)]
    of_body: dict[int, set[int]] = {}
    for one, places in bodies.items():
        for place in places:
            of_body.setdefault(place, set()).add(one)
    for meeting in of_body.values():
        for one in meeting:
            around[one] |= meeting - {one}
    return [one for one, _ in minimum_degree(around, range(count), balanced=True)]


NOTHING = np.zeros(3)


class Side(NamedTuple):
    """Body at a revolute joint, and the starts of the entries of J of both equations among the values."""

    body: int
    first: int
    second: int


def pin_lists(joints: Joints, system: System, kept: np.ndarray) -> dict[str, object] | None:
    """Return the lists of `stiffmbs.dynamics.elimination.native.layouts.PIN_ELIMINATION`; None if a joint is not revolute.

    `kept`: entries of J in solved equations.
    """
    gamma, pins = system.term("acceleration", "gamma"), _pins(joints, system, kept)
    if not pins or sum(joints.sizes) < system.n_c or not np.array_equal(np.sort(gamma.row), np.arange(system.n_c)):
        return None
    adjacent = [(k, later) for k, below in enumerate(joints.below) for later in below]
    meeting = [
        [(a, b) for a, own in enumerate(pins[k]) for b, side in enumerate(pins[later]) if own.body == side.body]
        for k, later in adjacent
    ]
    if max(map(len, meeting), default=0) > 1:
        return None
    mass, number = system.mass.reshape(-1, 3), {both: m for m, both in enumerate(adjacent)}
    starts = list(accumulate(map(len, joints.below), initial=0))
    lists = {
        "pin": [*_rows(joints, pins, gamma.source[np.argsort(gamma.row)], len(mass))],
        "inverse": [1.0 / mass[side.body] if side else NOTHING for sides in pins for side in (*sides, None)[:2]],
        "product": [
            PinProduct(8 * k + 4 * own, 8 * later + 4 * other)
            for (k, later), found in zip(adjacent, meeting, strict=True)
            for own, other in found or [(0, 0)]
        ],
        "mass": [
            mass[pins[k][found[0][0]].body] if found else NOTHING for (k, _), found in zip(adjacent, meeting, strict=True)
        ],
        "start": starts, "later": [later for _, later in adjacent],
        "update": [number[pair] for below in joints.below for pair in combinations(below, 2)],
        **{name: np.zeros(4 * len(adjacent)) for name in ("adjacent", "scaled")},
        **{name: np.zeros(width * len(pins)) for name, width in (("w", 8), ("block", 4), ("diagonal", 2), ("x", 2))},
    }  # fmt: skip
    return {**arrays_of(PIN_ELIMINATION, lists), "n": len(pins), "n_adjacent": len(adjacent)}


def _pins(joints: Joints, system: System, kept: np.ndarray) -> list[list[Side]]:
    """Return the bodies of each revolute joint; an empty list if any joint is of another kind."""
    jacobian, found = system.term("acceleration", "J"), dict[tuple[int, int], dict[int, int]]()
    columns = (part[kept].tolist() for part in (jacobian.row, jacobian.column, jacobian.source))
    for row, column, source in zip(*columns, strict=True):
        found.setdefault((row, column // 3), {})[column % 3] = source
    pins = []
    for rows, bodies in zip(joints.nodes, joints.bodies, strict=True):
        sides = [_side(body, *(found.get((row, body), {}) for row in rows.tolist())) for body in bodies]
        if None in sides or not 0 < len(sides) <= 2:
            return []
        pins.append([side for side in sides if side])
    return pins


def _side(body: int, *equations: dict[int, int]) -> Side | None:
    """Return a body at a joint, given the sources by velocity for each equation, x and angle, y and angle; None if it differs."""
    if [tuple(entries) for entries in equations] != [(k, 2) for k in range(2)]:
        return None
    (first, after_first), (second, after_second) = (entries.values() for entries in equations)
    return Side(body, first, second) if (after_first, after_second) == (first + 1, second + 1) else None


def _rows(joints: Joints, pins: list[list[Side]], gamma: np.ndarray, ground: int) -> Iterator[Pin]:
    """Yield the rows of ``pin``; the ground, with inverse mass 0, follows all bodies."""
    for rows, sides in zip(joints.nodes, pins, strict=True):
        i, j, row = sides[0], sides[-1], int(rows[0])
        velocities = 3 * i.body, 3 * (j.body if len(sides) == 2 else ground)
        yield Pin(i.first, i.second, j.first, j.second, int(gamma[row]), int(gamma[row + 1]), *velocities, row)
