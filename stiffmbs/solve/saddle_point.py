"""The block systems of rigid body mechanics: accelerations and multipliers, and both projections.

All three are [D J^T; J 0] [x; w] = [a; b], solved by one sparse LU whose pattern and pivots are found once.
"""

from __future__ import annotations

import heapq

import numpy as np

from ..compile.equations import ABSENT, Block, Equations, Formulation, Product
from ..compile.layout import FACTORS, packed
from ..compile.state import State
from ..compile.system import PLANAR

_SADDLE = (Block("u", "lam", "J.T"), Block("lam", "u", "J"))

ACCELERATIONS = Formulation(
    name="accelerations",
    unknowns=("u", "lam"),
    residual_set="acceleration",
    matrix_set="acceleration",
    residual=(Product("u", +1, "f"), Product("u", -1, "f_lam", "lam"), Product("lam", +1, "gamma")),
    matrix=(Block("u", "u", "M"), Block("u", "lam", "f_lam", -1), *_SADDLE),
)
"""[M J^T; J 0] [u'; lam] = [f; gamma]; one Newton step of it where friction makes f hang on lam."""

POSITION_STEP = Formulation(
    name="position step",
    unknowns=("u", "mu"),
    residual_set="position",
    matrix_set="position",
    residual=(Product("mu", -1, "C"),),
    matrix=(Block("u", "u", "I"), Block("u", "mu", "C_q.T"), Block("mu", "u", "C_q")),
)
"""[I C_q^T; C_q 0] [dq; w] = [0; -C]: Newton's smallest move towards the constraints."""

VELOCITY_STEP = Formulation(
    name="velocity step",
    unknowns=("u", "lam"),
    residual_set="motion",
    matrix_set="motion",
    residual=(Product("lam", -1, "V"),),
    matrix=(Block("u", "u", "M"), *_SADDLE),
)
"""[M J^T; J 0] [du; w] = [0; -V]: the smallest correction in the mass matrix."""


ROOM_FOR_PIVOTING = 4
"""Times the fill without pivoting that the factors may grow to when pivots leave the diagonal."""


class SaddlePoint:
    """One block system with its factors, ready for compiled code.

    Attributes
    ----------
    equations_table, factors_table : ndarrays of int
        Addresses (`stiffmbs.compile.layout`).
    """

    def __init__(self, formulation: Formulation, state: State) -> None:
        self.equations = Equations(formulation, state.system)
        state.load(formulation.residual_set)
        self.equations_table, self._slots = self.equations.table()
        n = self.equations.n
        rows, columns = self.equations.pattern
        order, fill = elimination_order(self.equations)
        room = ROOM_FOR_PIVOTING * fill + min(n * n, 4096) + n
        ints, floats = (lambda k: np.zeros(k, dtype=np.int64)), np.zeros
        self._arrays = {
            "n": n, "capacity": room, "ready": ints(1),
            "a_start": np.searchsorted(columns, np.arange(n + 1)).astype(np.int64),
            "a_row": rows.astype(np.int64), "a": floats(len(rows)), "scale": np.ones(n), "order": order,
            "l_start": ints(n + 1), "l_row": ints(room), "l": floats(room),
            "u_start": ints(n + 1), "u_row": ints(room), "u": floats(room),
            "pivot": ints(n), "work": floats(n), "b": floats(n), "previous": floats(n), "stack": ints(4 * n), "x": floats(n),
        }  # fmt: skip
        self.factors_table = packed(FACTORS, self._arrays)


def elimination_order(equations: Equations) -> tuple[np.ndarray, int]:
    """An order of elimination of a block system's unknowns with little fill: minimum degree on bodies and joints.

    Bodies and joints are eliminated whole; a joint waits until one of its bodies is gone, as its own diagonal
    block is zero before.

    Returns
    -------
    ndarray of int, int
        The unknowns in their order, and the entries that each triangle then has if pivots stay on the diagonal.
    """
    system = equations.system
    at_u, at_multiplier = (equations.at[name] for name in equations.formulation.unknowns)
    n_bodies = len(system.bodies)
    joints = [
        (group.first_row + e * group.record.n_equations, group.record.n_equations,
         {int(at) // PLANAR for at in group.index[e, : 2 * group.kind.n_bodies : 2] if at < system.n_q})
        for group in system.groups if group.record.n_equations for e in range(group.count)
    ]  # fmt: skip
    neighbours: list[set[int]] = [set() for _ in range(n_bodies + len(joints))]
    for k, (_, _, bodies) in enumerate(joints):
        for body in bodies:
            neighbours[n_bodies + k].add(body)
            neighbours[body].add(n_bodies + k)
    queue = [(len(neighbours[k]), k) for k in range(n_bodies)]
    heapq.heapify(queue)
    gone = [False] * len(neighbours)
    size = [PLANAR] * n_bodies + [count for _, count, _ in joints]
    order: list[int] = []
    fill = 0
    while queue:
        degree, node = heapq.heappop(queue)
        if gone[node] or degree != len(neighbours[node]):
            continue
        gone[node] = True
        if node < n_bodies:
            order += [*at_u[PLANAR * node : PLANAR * (node + 1)]]
        else:
            first, count, _ = joints[node - n_bodies]
            order += [at for at in at_multiplier[first : first + count] if at != ABSENT]
        around = neighbours[node]
        fill += size[node] * (size[node] + sum(size[other] for other in around))
        for other in around:
            neighbours[other] |= around
            neighbours[other] -= {node, other}
        for other in around:
            heapq.heappush(queue, (len(neighbours[other]), other))
    return np.array(order, dtype=np.int64), fill
