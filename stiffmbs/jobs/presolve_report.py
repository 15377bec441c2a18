"""What the presolve left out, in sentences, and the number of unknowns before and after."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from ..compile.coordinates import STILL, Coordinates
from ..compile.system import System
from ..solve.mechanics import Mechanics
from ..solve.subsystems import Piece
from ..structure.overconstraint import listed


def unknowns(whole: System, pieces: Sequence[Piece], mechanics: Mechanics) -> tuple[int, int]:
    """Unknowns of the formulation SI2 (q, u, mu, lam): of all bodies and equations, and of what is solved for."""
    everything = whole.n_q + whole.n_u + int(whole.holonomic.sum()) + whole.n_c
    solved = [piece.mechanics for piece in pieces] or [mechanics]
    return everything, sum(map(_solved_for, solved))


def _solved_for(mechanics: Mechanics) -> int:
    system, coordinates = mechanics.system, mechanics.coordinates
    rows = system.active & ~coordinates.fulfilled
    free = int(coordinates.independent.sum()) + int(coordinates.independent_u.sum())
    return free + int((system.holonomic & rows).sum()) + int(rows.sum())


def presolve_sentences(whole: System, pieces: Sequence[Piece], mechanics: Mechanics) -> Iterator[str]:
    """A sentence for each thing that is left out; nothing where all is solved for."""
    redundant = np.flatnonzero(~mechanics.system.active).tolist()
    if redundant:
        yield f"redundant equations left out: {listed([_equation(whole, row) for row in redundant])}"
    for piece in pieces:
        yield from _merged(whole, piece)
    for part in [piece.mechanics for piece in pieces] or [mechanics]:
        yield from _left_out(part)
    if len(pieces) > 1:
        inside = [listed([whole.bodies[k] for k in piece.part.bodies]) for piece in pieces]
        yield f"{len(pieces)} independent mechanisms solved apart: {'; '.join(inside)}"
    before, after = unknowns(whole, pieces, mechanics)
    if after != before:
        yield f"{before} unknowns become {after}"


def _merged(whole: System, piece: Piece) -> Iterator[str]:
    for carrier, count in Counter(piece.part.carrier.tolist()).items():
        if count > 1:
            names = [whole.bodies[k] for k in piece.part.bodies[piece.part.carrier == carrier]]
            yield f"fixed joints make one body of {listed(names)}"


def _left_out(mechanics: Mechanics) -> Iterator[str]:
    system, coordinates = mechanics.system, mechanics.coordinates
    still = np.flatnonzero(coordinates.leader == STILL).tolist()
    if still:
        names = list(dict.fromkeys(_coordinate(system, k) for k in still))
        yield f"held still by constant equations: {listed(names)}"
    tied = np.flatnonzero((coordinates.leader != STILL) & ~coordinates.independent).tolist()
    if tied:
        yield f"tied in a constant ratio: {listed([_tie(system, coordinates, k) for k in tied])}"
    rows = np.flatnonzero(coordinates.fulfilled).tolist()
    if rows:
        yield f"their multipliers are computed afterwards: {listed([_equation(system, row) for row in rows])}"


def _coordinate(system: System, k: int) -> str:
    """Its name; those of a quaternion are one orientation."""
    body, place = divmod(k, system.of_body.n_q)
    if system.of_body.n_q > system.of_body.n_u and place >= system.of_body.linear:
        return f"{system.bodies[body]}.orientation"
    return system.name_of(k, system.of_body.positions)


def _tie(system: System, coordinates: Coordinates, k: int) -> str:
    return f"{_coordinate(system, k)} ({coordinates.ratio[k]:.6g} of {_coordinate(system, coordinates.leader[k])})"


def _equation(system: System, row: int) -> str:
    return ".".join(system.equations[row])
