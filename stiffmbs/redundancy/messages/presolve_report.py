"""Messages on the presolve, and the number of unknowns before and after."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...compile.coordinates import FIXED, Coordinates
from ...compile.system import System
from ...dynamics.dynamics import Dynamics
from ...notes import Note, NoteKind
from ..listed import listed
from ..redundancy import Redundancy

if TYPE_CHECKING:
    from ...solve.subsystems import Subsystem


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
        yield f"{len(subsystems)} independent mechanisms solved separately: {'; '.join(inside)}"
    before, after = unknowns(whole, subsystems, dynamics)
    if after < before:
        yield f"{before} unknowns reduced to {after}"
    if after > before:
        yield f"{after} unknowns in place of {before}, so that bodies that spin do not limit the steps"


def _of_bodies(whole: System, subsystem: Subsystem) -> Iterator[str]:
    for parent, count in Counter(subsystem.part.parent.tolist()).items():
        if count > 1:
            names = [whole.bodies[k] for k in subsystem.part.bodies[subsystem.part.parent == parent]]
            yield f"bodies merged by fixed joints: {listed(names)}"
    spinning = np.isin(subsystem.part.parent, [spin.body for spin in subsystem.part.spins])
    if spinning.any():
        names = [whole.bodies[k] for k in subsystem.part.bodies[spinning]]
        yield f"spin angle separated from the orientation: {listed(names)}"


def _left_out(dynamics: Dynamics) -> Iterator[str]:
    system, coordinates = dynamics.system, dynamics.coordinates
    still = np.flatnonzero(coordinates.independent_of == FIXED).tolist()
    if still:
        yield f"coordinates fixed by constant equations: {listed(list(dict.fromkeys(_names(system, still))))}"
    tied = np.flatnonzero((coordinates.independent_of != FIXED) & ~coordinates.independent).tolist()
    if tied:
        yield f"coordinates in a constant ratio: {listed(_ties(system, coordinates, tied))}"
    rows = np.flatnonzero(coordinates.satisfied).tolist()
    if rows:
        yield f"multipliers recovered afterwards: {listed([_equation(system, row) for row in rows])}"


def _names(system: System, coordinates: Sequence[int]) -> list[str]:
    """Return the names of coordinates; components of a quaternion are one orientation."""
    of_body, labels = system.of_body, system.of_body.positions
    if of_body.n_q > of_body.n_u:
        labels = (*labels[: of_body.linear], *["orientation"] * (of_body.n_q - of_body.linear))
    return system.names_of(coordinates, labels)


def _ties(system: System, coordinates: Coordinates, tied: list[int]) -> list[str]:
    leaders = _names(system, coordinates.independent_of[tied].tolist())
    return [
        f"{name} ({ratio:.6g} of {leader})"
        for name, ratio, leader in zip(_names(system, tied), coordinates.ratio[tied], leaders, strict=True)
    ]


def _equation(system: System, row: int) -> str:
    return ".".join(system.equations[row])


class StructureNotes(NamedTuple):
    """Messages on a structure.

    `of_joints`: on redundant equations and unconnected bodies. `of_presolve`: on bodies, coordinates and equations
    that the presolve removes. `not_unique`: channels of the reactions without a unique value.
    """

    of_joints: tuple[Note, ...]
    of_presolve: tuple[str, ...]
    not_unique: tuple[str, ...]


def structure_notes(redundancy: Redundancy, subsystems: Sequence[Subsystem], dynamics: Dynamics) -> StructureNotes:
    """Return the messages on the structure of an examined and presolved system, cached for all its runs."""
    return dynamics.once(lambda dynamics: _found(redundancy, subsystems, dynamics), name="structure notes")


def _found(redundancy: Redundancy, subsystems: Sequence[Subsystem], dynamics: Dynamics) -> StructureNotes:
    redundant: Iterable[Note] = ()
    if redundancy.rank_results:
        from .redundancy import redundancy_notes

        redundant = redundancy_notes(redundancy)
    return StructureNotes(
        (*redundant, *unconnected_notes(dynamics.system)),
        tuple(presolve_sentences(dynamics.system, subsystems, dynamics)),
        redundancy.not_unique,
    )


UNCONNECTED = NoteKind("unconnected", "{names} not connected: no joint and no force except gravity acts there")


def unconnected_notes(system: System) -> Iterator[Note]:
    """Yield a note on unconnected bodies, if others are connected."""
    if alone := _unconnected(system):
        names = f"{', '.join(alone[:-1])} and {alone[-1]} are" if len(alone) > 1 else f"{alone[0]} is"
        yield UNCONNECTED(alone[0], names=names)


def _unconnected(system: System) -> tuple[str, ...]:
    """Return the bodies without joint or force, which no formula of one reads, if other bodies have some.

    Weight and requests do not connect. If no joint or force acts at all, as for a thrown body, no body is returned.
    """
    touched = np.zeros(len(system.bodies) + 1, dtype=bool)
    for group in system.groups:
        if group.kind.element.kind:
            touched[group.bodies.ravel()] = True
    alone = np.flatnonzero(~touched[:-1])
    return tuple(system.bodies[k] for k in alone) if touched[:-1].any() else ()
