"""Bodies that nothing connects with anything, in a sentence."""

from __future__ import annotations

from collections.abc import Iterator

from ...compile.system import System
from ..unconnected import unconnected


def unconnected_sentence(system: System) -> Iterator[str]:
    """That bodies are connected to nothing, where some are and others are not."""
    alone = unconnected(system)
    if alone:
        names = f"{', '.join(alone[:-1])} and {alone[-1]} are" if len(alone) > 1 else f"{alone[0]} is"
        yield f"{names} connected to nothing: no joint and no force but weight acts there"
