"""Errors of shell elements in published problems, and the processor time of each solution."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tests.flexible_bodies.shells.meshes import KINDS
from tests.flexible_bodies.shells.published import BEAMS, PROBLEMS, STRESSES

from ...benchmark import Row

DIVISIONS = {"plate or shell": (4, 8, 16, 32), "beam": (1, 2, 4, 8)}
"""Elements on each side, or across a beam."""


@dataclass(frozen=True)
class Shells:
    """Published plates, shells and beams by quadrilaterals and triangles."""

    name: str

    def measured(self) -> list[Row]:
        """Solve all problems with all divisions."""
        return [*_rows(4)]

    def glanced(self) -> list[Row]:
        """Solve all problems with the coarsest mesh."""
        return [*_rows(1)]


def _rows(most: int) -> Iterator[Row]:
    for problems, divisions in zip((PROBLEMS | STRESSES, BEAMS), DIVISIONS.values(), strict=True):
        for name, ratio in problems.items():
            for kind in KINDS:
                for n in divisions[:most]:
                    begun = time.process_time()
                    error = float(np.abs(np.asarray(ratio(kind, n)) - 1).max())
                    yield Row(name, f"{n} {kind}s", error, time.process_time() - begun, False)


BENCHMARKS = (Shells("shells"),)
