"""Fill-reducing elimination order of a block system's unknowns, with its cost, and memory for its factors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..compile.equations import ABSENT, Equations
from ..compile.system import System
from ..compile.terms import TERM_AXES
from .minimum_degree import minimum_degree


class EliminationOrder(NamedTuple):
    """Elimination order with little fill-in.

    `unknowns` of shape (n,). `fill`: entries of each triangle with pivots on the diagonal and full blocks of bodies and
    joints. `updates`: multiplications of the elimination under the same conditions.
    """

    unknowns: np.ndarray
    fill: int
    updates: int


def elimination_order(equations: Equations) -> EliminationOrder:
    """Return a minimum degree order of whole bodies and joints.

    The diagonal block of a joint is zero, or nearly zero with relaxed rows, until bodies of the joint are eliminated.
    A joint waits until its block is regular in every pose (`stiffmbs.sparse.elimination_order`).  Pivots then
    stay on the diagonal and the fill-in is as estimated, for trees and loops.
    """
    n_bodies, owner = _owners(equations)
    present = [at[at != ABSENT] for at in reversed(equations.at.values())]  # u before q of a body
    natural = np.concatenate([np.empty(0, dtype=np.int64), *present])
    by_owner = natural[np.argsort(owner[natural], kind="stable")]
    sizes = np.bincount(owner, minlength=n_bodies + len(equations.system.joint_start) - 1)
    parts = [by_owner[start:end] for start, end in pairwise([0, *np.cumsum(sizes).tolist()])]
    rows, columns = equations.pattern
    pairs = np.sort(owner[rows] * len(parts) + owner[columns])
    coupled = (divmod(both, len(parts)) for both in pairs[np.diff(pairs, prepend=-1) > 0].tolist())
    return _ordered(parts, coupled, _counted(equations, owner, len(parts)), n_bodies)


def _ordered(
    parts: list[np.ndarray], coupled: Iterable[tuple[int, int]], counted: list[int], n_bodies: int
) -> EliminationOrder:
    """Return the order of unknowns in parts, given the pairs of coupled parts; the rest as in `_in_order`."""
    sizes = [len(part) for part in parts]
    neighbours: list[set[int]] = [set() for _ in parts]
    for a, b in coupled:
        if a != b and min(a, b) >= 0:
            neighbours[a].add(b)
            neighbours[b].add(a)
    order, fill, updates = [np.empty(0, dtype=np.int64)], 0, 0
    for node, around in _in_order(neighbours, counted, n_bodies):
        order.append(parts[node])
        height = sizes[node] + sum(sizes[other] for other in around)
        fill += sizes[node] * height
        updates += sizes[node] * height * height
    return EliminationOrder(np.concatenate(order), fill, updates)


COUPLING = ("f_q", "f_u", "G_lam", "J", "C_x", "rate_q", "rate_u")
"""Terms of a balance of forces that couple bodies, states and joints."""


def order_by_blocks(system: System) -> EliminationOrder:
    """Return a minimum degree order of the velocities, states and multipliers of a balance of forces."""
    width, n_bodies, n_states = system.of_body, len(system.bodies), len(system.states)
    sizes = [width.n_u] * n_bodies + [1] * n_states + np.diff(system.joint_start).tolist()
    of_coordinates = np.full(system.n_q, -1)  # revolution counters are no unknowns
    of_coordinates[: system.n_pose] = np.arange(system.n_pose) // width.n_q
    of_coordinates[system.first_state :] = n_bodies + np.arange(n_states)
    blocks = {
        "u": np.arange(system.n_u) // width.n_u,
        "q": of_coordinates,
        "c": np.repeat(np.arange(n_bodies + n_states, len(sizes)), np.diff(system.joint_start)),
    }
    coupled: list[tuple[int, int]] = []
    for name in COUPLING:
        term, axes = system.term("tangent", name), TERM_AXES[name]
        coupled += sorted(
            {*zip(blocks[axes[0]][term.row].tolist(), blocks[axes[1]][term.column].tolist(), strict=True)}
        )
    parts = [np.arange(start, end) for start, end in pairwise(np.cumsum([0, *sizes]).tolist())]
    return _ordered(parts, coupled, sizes, n_bodies + n_states)


def factors_of(n: int, rows: np.ndarray, columns: np.ndarray, order: EliminationOrder) -> dict[str, object]:
    """Return the contents of the layout `stiffmbs.compile.machine.native.tables.FACTORS`.

    `n`: number of unknowns. `rows`, `columns`: entries, by columns. `order`: elimination order of the columns, with its
    fill-in.
    """
    return {
        "n": n, "expected_entries": order.fill + n,
        "a_start": np.searchsorted(columns, np.arange(n + 1)).astype(np.int64, copy=False),
        "a_row": np.ascontiguousarray(rows, dtype=np.int64), "a": np.zeros(len(rows)), "factored": np.zeros(len(rows)), "scale": np.ones(n), "order": order.unknowns,
        **{name: np.zeros(size, dtype=np.int64) for name, size in (("l_start", n + 1), ("u_start", n + 1), ("pivot", n), ("stack", 4 * n))},
        **{name: np.zeros(n) for name in ("work", "b", "previous", "x")},
    }  # fmt: skip


def nodes_in_order(equations: Equations, order: EliminationOrder) -> list[np.ndarray]:
    """Return the unknowns of each body's coordinates, of its velocities and of each joint, in the order of elimination.

    The diagonal block of coordinates is close to cj times the identity for any forces.  After its elimination, that of
    velocities contains masses, dampers and springs.
    """
    _, owner = _owners(equations)
    place = np.full(equations.n, -1)
    kinds = [name for name in ("q", "u", "mu", "lam") if name in equations.at]
    part = np.zeros(equations.n, dtype=np.int64)
    for k, name in enumerate(kinds):
        at = equations.at[name]
        part[at[at != ABSENT]] = k
    place[order.unknowns] = np.arange(equations.n)
    first = np.full(int(owner.max(initial=-1)) + 1, equations.n)
    np.minimum.at(first, owner, place)
    node = 2 * first[owner] + (part == kinds.index("u") if "u" in kinds else 0)
    sequence = np.lexsort((np.arange(equations.n), part, node))
    return np.split(sequence, np.flatnonzero(np.diff(node[sequence])) + 1)


def _owners(equations: Equations) -> tuple[int, np.ndarray]:
    """Return the number of bodies, and the body of each unknown or the number of bodies plus its joint."""
    system = equations.system
    n_bodies = len(system.bodies)
    width = {"q": system.of_body.n_q, "x": system.of_body.n_q, "s": system.of_body.n_q, "u": system.of_body.n_u}
    owner = np.zeros(equations.n, dtype=np.int64)
    joint = n_bodies + np.repeat(np.arange(len(system.joint_start) - 1), np.diff(system.joint_start))
    for name, at in equations.at.items():
        owners = np.minimum(np.arange(len(at)) // width[name], n_bodies - 1) if name in width else joint
        owner[at[at != ABSENT]] = owners[at != ABSENT]
    return n_bodies, owner


def _counted(equations: Equations, owner: np.ndarray, n_owners: int) -> list[int]:
    """Return the number of velocities of each body and of equations of each joint, on one level."""
    at = equations.at
    level = [at["u"] if "u" in at else at["q"], at["lam"] if "lam" in at else at["mu"]]
    unknowns = np.concatenate(level)
    counted: list[int] = np.bincount(owner[unknowns[unknowns != ABSENT]], minlength=n_owners).tolist()
    return counted


def _in_order(neighbours: list[set[int]], counted: list[int], n_bodies: int) -> Iterator[tuple[int, set[int]]]:
    """Yield nodes in minimum degree order, bodies before joints, with the neighbours that each has then.

    `counted` holds the velocities of bodies and the equations of joints.  A waiting joint is checked after the
    elimination of each neighbour; those that wait at the end come last.
    """
    bodies_of = [sorted(k for k in around if k < n_bodies) for around in neighbours[n_bodies:]]
    bodies = EliminatedBodies(bodies_of, counted[:n_bodies], counted[n_bodies:])

    def may_go(node: int) -> bool:
        if node >= n_bodies:
            return bodies.eliminated_joint(node - n_bodies)
        bodies.eliminate(node)
        return True

    waiting = dict.fromkeys(range(len(neighbours)))
    for node, around in minimum_degree(neighbours, range(n_bodies), may_go):
        del waiting[node]
        yield node, around
    yield from ((node, set()) for node in waiting)


class EliminatedBodies:
    """Eliminated bodies, in groups connected by eliminated joints.

    After the elimination of bodies B and joints E, the pivots of [M J^T; J 0] are regular if the rows of E have full
    rank in the columns of B.  This holds for joints with all bodies in B, because J has full rank.  A joint with a body
    outside of B acts as a joint to ground, so it may close a loop that has redundant rows or a dead centre.  A group
    may therefore have either joints to ground or one such open joint: the rows of a single open joint on a free group
    are independent of those inside.  If bodies have few coordinates, such as a body that slides along an axis, the
    group must have as many degrees of freedom as its joints have rows. `bodies_of`: bodies of each joint, without
    ground. `freedoms`: number of velocities of each body. `rows`: number of equations of each joint.
    """

    def __init__(self, bodies_of: Sequence[Sequence[int]], freedoms: Sequence[int], rows: Sequence[int]) -> None:
        n_bodies = len(freedoms)
        self._bodies_of, self._rows = bodies_of, rows
        self._left = list(freedoms)
        self._gone = [False] * n_bodies
        self._parent = list(range(n_bodies))
        self._grounded = [False] * n_bodies
        self._open: list[int] = [0] * n_bodies
        self._waiting: list[list[int]] = [[] for _ in range(n_bodies)]

    def eliminate(self, body: int) -> None:
        """Eliminate a body: joints that were open towards it become part of its group."""
        self._gone[body] = True
        for joint in self._waiting[body]:
            group = self._joined(joint)
            if all(self._gone[other] for other in self._bodies_of[joint]):
                self._open[group] -= 1

    def eliminated_joint(self, joint: int) -> bool:
        """Eliminate a joint if its pivots are regular; return True in that case."""
        bodies = self._bodies_of[joint]
        groups = {self._group(body) for body in bodies if self._gone[body]}
        ahead = [body for body in bodies if not self._gone[body]]
        grounded = len(bodies) == 1 or any(self._grounded[group] for group in groups)
        n_open = sum(self._open[group] for group in groups) + bool(ahead)
        if not groups or n_open > 1 or (n_open and grounded):
            return False
        if n_open and sum(self._left[group] for group in groups) < self._rows[joint]:
            return False
        group = self._joined(joint)
        self._left[group] -= self._rows[joint]
        self._grounded[group], self._open[group] = grounded, n_open
        for body in ahead:
            self._waiting[body].append(joint)
        return True

    def _group(self, body: int) -> int:
        """Return the representative of an eliminated body's group."""
        while self._parent[body] != body:
            self._parent[body] = self._parent[self._parent[body]]
            body = self._parent[body]
        return body

    def _joined(self, joint: int) -> int:
        """Merge the groups of all eliminated bodies of a joint, and return the result."""
        first, *others = {self._group(body) for body in self._bodies_of[joint] if self._gone[body]}
        for other in others:
            self._parent[other] = first
            self._grounded[first] |= self._grounded[other]
            self._open[first] += self._open[other]
            self._left[first] += self._left[other]
        return first
