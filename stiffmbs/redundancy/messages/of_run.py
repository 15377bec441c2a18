"""Messages of a run on its mechanism's structure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...solve.dynamics import Dynamics
from ...solve.subsystems import Subsystem
from ..redundancy import Redundancy
from .presolve_report import presolve_sentences
from .unconnected import unconnected_sentence


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
