"""Several solutions of accelerations and reactions: friction in joints whose loads depend on this friction."""

from __future__ import annotations

import numpy as np

from .dynamics import Dynamics

ANOTHER = 1e-3
"""Difference of two solutions, relative to the largest multiplier, from which on they are different ones."""


def ambiguous_loads(
    dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, lam: np.ndarray | None = None
) -> list[str]:
    """Return the joints whose loads have several solutions at a state; empty if only one was found.

    Forces that depend on multipliers make the equations piecewise linear, or nearly so. Newton's method finds the solution
    of another piece from multipliers of the opposite sign: of one joint, or of all with such forces. `lam` of shape (n_c,): a
    solution; computed by default. The state of `dynamics` is changed.

    References
    ----------
    Pfeiffer and Glocker, Multibody Dynamics with Unilateral Contacts (1996): friction with several solutions or none.
    """
    system, state = dynamics.system, dynamics.state
    if not system.forces_by_reactions:
        return []
    state.q[:], state.u[:] = q, u
    if lam is None:
        if dynamics.accelerate(t)[0] < 0:
            return []
        lam = state.lam.copy()
    joints: dict[str, list[int]] = {}
    for row in sorted(set(system.term("acceleration", "f_lam").column.tolist())):
        joints.setdefault(system.equations[row][0], []).append(row)
    opposite = list(joints.values())
    if len(joints) > 1:
        opposite.append([row for rows in joints.values() for row in rows])
    for rows in opposite:
        state.lam[:] = lam
        state.lam[rows] *= -1.0
        if dynamics.accelerate(t)[0] < 0:
            continue
        apart = np.abs(state.lam - lam)
        if apart.max() > ANOTHER * np.abs(lam).max():
            return [name for name, rows in joints.items() if apart[rows].max() > ANOTHER * apart.max()]
    return []


REMEDY = "use less friction, a longer guide, or bushings in place of the joints, whose deflections determine the loads"


def ambiguous_loads_clause(
    dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, lam: np.ndarray | None = None
) -> str:
    """Return a clause on the joints of `ambiguous_loads`; empty if there are none."""
    joints = ambiguous_loads(dynamics, t, q, u, lam)
    if not joints:
        return ""
    depend = "depend on each other" if len(joints) > 1 else "depend on themselves"
    return (
        f"the loads of {' and '.join(joints)} {depend} by the friction of {' and '.join(dynamics.system.forces_by_reactions)}, and "
        "have more than one solution"
    )
