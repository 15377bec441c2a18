"""Selection of joints that can be eliminated from a block system with regular pivots in every pose."""

from __future__ import annotations

from collections.abc import Sequence


class EliminatedBodies:
    """Eliminated bodies, in groups connected by eliminated joints.

    After the elimination of bodies B and joints E, the pivots of [M J^T; J 0] are regular if the rows of E have full
    rank in the columns of B.  This holds for joints with all bodies in B, because J has full rank.  A joint with a body
    outside of B acts as a joint to ground, so it may close a loop that has redundant rows or a dead centre.  A group
    may therefore have either joints to ground or one such open joint: the rows of a single open joint on a free group
    are independent of those inside.  If bodies have few coordinates, such as a body that slides along an axis, the
    group must have as many degrees of freedom as its joints have rows.

    Parameters
    ----------
    bodies_of : sequence of sequences of int
        Bodies of each joint, without ground.
    freedoms : sequence of int
        Number of velocities of each body.
    rows : sequence of int
        Number of equations of each joint.
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
