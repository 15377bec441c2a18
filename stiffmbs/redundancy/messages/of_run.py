"""What a run says of its mechanism's structure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...solve.dynamics import Dynamics
from ...solve.subsystems import Subsystem
from ..redundancy import Redundancy
from .presolve_report import presolve_sentences
from .unconnected import unconnected_sentence


class StructureNotes(NamedTuple):
    """Sentences on a structure.

    Attributes
    ----------
    of_joints : tuple of str
        On redundant equations, and on bodies that nothing connects.
    of_presolve : tuple of str
        On what is not solved for.
    not_unique : tuple of str
        Channels of the reactions without a unique value.
    """

    of_joints: tuple[str, ...]
    of_presolve: tuple[str, ...]
    not_unique: tuple[str, ...]


def structure_notes(redundancy: Redundancy, subsystems: Sequence[Subsystem], dynamics: Dynamics) -> StructureNotes:
    """What there is to say of the structure of a system that was examined and presolved; found once for all runs of it."""
    return dynamics.kept("structure notes", None, lambda: _found(redundancy, subsystems, dynamics))


def _found(redundancy: Redundancy, subsystems: Sequence[Subsystem], dynamics: Dynamics) -> StructureNotes:
    return StructureNotes(
        (*_redundant(redundancy), *unconnected_sentence(dynamics.system)),
        tuple(presolve_sentences(dynamics.system, subsystems, dynamics)),
        redundancy.not_unique,
    )


def _redundant(redundancy: Redundancy) -> Iterator[str]:
    if redundancy.rank_results:
        from .redundancy import note_sentences  # trees do not pay for it

        yield from note_sentences(redundancy)
