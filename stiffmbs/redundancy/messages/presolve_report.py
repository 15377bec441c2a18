"""Messages on the presolve, and the number of unknowns before and after."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from ...compile.coordinates import FIXED, Coordinates
from ...compile.system import System
from ...dynamics.dynamics import Dynamics
from ...solve.subsystems import Subsystem
from ..overconstraint import listed


def unknowns(whole: System, subsystems: Sequence[Subsystem], dynamics: Dynamics) -> tuple[int, int]:
    """Return the number of unknowns of the formulation SI2 (q, u, mu, lam) without and with presolve."""
    everything = whole.n_q + whole.n_u + int(whole.holonomic.sum()) + whole.n_c
    solved = [subsystem.dynamics for subsystem in subsystems] or [dynamics]
    return everything, sum(map(_solved_for, solved))


def _solved_for(dynamics: Dynamics) -> int:
    system, coordinates = dynamics.system, dynamics.coordinates
    rows = system.active & ~coordinates.satisfied
    free = int(coordinates.independent.sum()) + int(coordinates.independent_u.sum())
    return free + int((system.holonomic & rows).sum()) + int(rows.sum())


def presolve_sentences(whole: System, subsystems: Sequence[Subsystem], dynamics: Dynamics) -> Iterator[str]:
    """Yield a sentence for each kind of removal."""
    redundant = np.flatnonzero(~dynamics.system.active).tolist()
    if redundant:
        yield f"redundant equations left out: {listed([_equation(whole, row) for row in redundant])}"
    for subsystem in subsystems:
        yield from _of_bodies(whole, subsystem)
    for part in [subsystem.dynamics for subsystem in subsystems] or [dynamics]:
        yield from _left_out(part)
    if len(subsystems) > 1:
        inside = [listed([whole.bodies[k] for k in subsystem.part.bodies]) for subsystem in subsystems]
        yield f"{len(subsystems)} independent mechanisms solved apart: {'; '.join(inside)}"
    before, after = unknowns(whole, subsystems, dynamics)
    if after != before:
        yield f"{before} unknowns become {after}"


def _of_bodies(whole: System, subsystem: Subsystem) -> Iterator[str]:
    for parent, count in Counter(subsystem.part.parent.tolist()).items():
        if count > 1:
            names = [whole.bodies[k] for k in subsystem.part.bodies[subsystem.part.parent == parent]]
            yield f"fixed joints make one body of {listed(names)}"
    spinning = np.isin(subsystem.part.parent, [spin.body for spin in subsystem.part.spins])
    if spinning.any():
        names = [whole.bodies[k] for k in subsystem.part.bodies[spinning]]
        yield f"the angle of spin is a coordinate of its own: {listed(names)}"


def _left_out(dynamics: Dynamics) -> Iterator[str]:
    system, coordinates = dynamics.system, dynamics.coordinates
    still = np.flatnonzero(coordinates.independent_of == FIXED).tolist()
    if still:
        names = list(dict.fromkeys(_coordinate(system, k) for k in still))
        yield f"held still by constant equations: {listed(names)}"
    tied = np.flatnonzero((coordinates.independent_of != FIXED) & ~coordinates.independent).tolist()
    if tied:
        yield f"tied in a constant ratio: {listed([_tie(system, coordinates, k) for k in tied])}"
    rows = np.flatnonzero(coordinates.satisfied).tolist()
    if rows:
        yield f"their multipliers are computed afterwards: {listed([_equation(system, row) for row in rows])}"


def _coordinate(system: System, k: int) -> str:
    """Return its name; components of a quaternion are one orientation."""
    body, place = divmod(k, system.of_body.n_q)
    if system.of_body.n_q > system.of_body.n_u and place >= system.of_body.linear:
        return f"{system.bodies[body]}.orientation"
    return system.name_of(k, system.of_body.positions)


def _tie(system: System, coordinates: Coordinates, k: int) -> str:
    return (
        f"{_coordinate(system, k)} ({coordinates.ratio[k]:.6g} of {_coordinate(system, coordinates.independent_of[k])})"
    )


def _equation(system: System, row: int) -> str:
    return ".".join(system.equations[row])
