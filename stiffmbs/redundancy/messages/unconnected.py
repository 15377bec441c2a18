"""Bodies that nothing connects with anything, in a sentence."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...compile.system import System


def unconnected_sentence(system: System) -> Iterator[str]:
    """That bodies are connected to nothing, where some are and others are not."""
    alone = _unconnected(system)
    if alone:
        names = f"{', '.join(alone[:-1])} and {alone[-1]} are" if len(alone) > 1 else f"{alone[0]} is"
        yield f"{names} connected to nothing: no joint and no force but weight acts there"


def _unconnected(system: System) -> tuple[str, ...]:
    """The bodies on which neither a joint nor a force acts, and that no formula of one reads, beside others that have such.

    Weight connects nothing, nor does a request.  Of a scene in which no joint and no force acts at all, as a body thrown or
    spun, there are none: its bodies are meant to be free.
    """
    touched = np.zeros(len(system.bodies) + 1, dtype=bool)
    for group in system.groups:
        if group.kind.element.kind:
            touched[group.bodies.ravel()] = True
    alone = np.flatnonzero(~touched[:-1])
    return tuple(system.bodies[k] for k in alone) if touched[:-1].any() else ()
