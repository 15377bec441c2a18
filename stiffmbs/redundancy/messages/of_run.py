"""Messages of a run on its mechanism's structure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ...compile.system import System
from ...dynamics.dynamics import Dynamics
from ...solve.subsystems import Subsystem
from ..redundancy import Redundancy
from .presolve_report import presolve_sentences


class StructureNotes(NamedTuple):
    """Messages on a structure.

    Attributes
    ----------
    of_joints : tuple of str
        On redundant equations and unconnected bodies.
    of_presolve : tuple of str
        On bodies, coordinates and equations that the presolve removes.
    not_unique : tuple of str
        Channels of the reactions without a unique value.
    """

    of_joints: tuple[str, ...]
    of_presolve: tuple[str, ...]
    not_unique: tuple[str, ...]


def structure_notes(redundancy: Redundancy, subsystems: Sequence[Subsystem], dynamics: Dynamics) -> StructureNotes:
    """Return the messages on the structure of an examined and presolved system, cached for all its runs."""
    return dynamics.kept("structure notes", None, lambda: _found(redundancy, subsystems, dynamics))


def _found(redundancy: Redundancy, subsystems: Sequence[Subsystem], dynamics: Dynamics) -> StructureNotes:
    return StructureNotes(
        (*_redundant(redundancy), *unconnected_sentence(dynamics.system)),
        tuple(presolve_sentences(dynamics.system, subsystems, dynamics)),
        redundancy.not_unique,
    )


def _redundant(redundancy: Redundancy) -> Iterator[str]:
    if redundancy.rank_results:
        from .redundancy import note_sentences  # not imported for trees

        yield from note_sentences(redundancy)


def unconnected_sentence(system: System) -> Iterator[str]:
    """Yield a sentence on unconnected bodies, if others are connected."""
    if alone := _unconnected(system):
        names = f"{', '.join(alone[:-1])} and {alone[-1]} are" if len(alone) > 1 else f"{alone[0]} is"
        yield f"{names} connected to nothing: no joint and no force but weight acts there"


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
