"""Message on unconnected bodies."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...compile.system import System


def unconnected_sentence(system: System) -> Iterator[str]:
    """Yield a sentence on unconnected bodies, if others are connected."""
    alone = _unconnected(system)
    if alone:
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
