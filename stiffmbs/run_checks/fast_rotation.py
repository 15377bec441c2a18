"""Note on flexible bodies that rotate fast: if their geometric stiffening is included."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import OutputRows
from ..elements.spatial.flexible.layout import BODY, MODE, MODES, OF_MODE, OF_PAIR, PAIR
from .parameters import RUN_CHECKS

ROUNDING = 1e-10
"""Relative size of a term that is zero but for rounding."""


def fast_rotation_notes(system: System, rows: OutputRows) -> Iterator[str]:
    """Yield a note on each flexible body whose rotation changes its stiffness."""
    for group in system.groups:
        for e in range(group.count if group.entries["inertia"] and len(rows.t) else 0):
            body = int(group.bodies[e, 0])
            first = int(group.index[e, 2 * group.kind.n_bodies])
            numbers = group.numbers[first + int(group.numbers[first]) :]
            modes = 3 * (group.kind.n_bodies - 1)
            stiffness = numbers[MODES : MODES + OF_MODE * modes].reshape(modes, OF_MODE)[
                :, list(MODE).index("stiffness")
            ]
            start = system.of_body.n_u * body + system.of_body.linear
            rate = float(np.linalg.norm(rows.u[:, start : start + 3], axis=1).max())
            lowest = float(np.sqrt(stiffness.min(initial=np.inf) / numbers[MODES - BODY["modal_mass"]]))
            if rate > RUN_CHECKS.fast * lowest:
                start = MODES + OF_MODE * modes
                included = _of_second_order(numbers[start : start + OF_PAIR * modes**2].reshape(-1, OF_PAIR))
                yield (
                    f"'{group.names[e]}' turns at up to {rate:.3g} rad/s, {100 * rate / lowest:.2g} % of its lowest natural frequency "
                    f"of {lowest / (2 * np.pi):.3g} Hz: its stiffening by centrifugal forces is {INCLUDED if included else NOT_INCLUDED}"
                )


INCLUDED = "included by displacements of second order; compare with an exact beam if an interface carries a heavy load"
NOT_INCLUDED = "not included; set stiffening: true for a mesh, or compare with a body divided into several"


def _of_second_order(pairs: np.ndarray) -> bool:
    """Return True if pairs of modes have displacements of second order: the trace of W differs from zero."""
    trace, diagonal = list(PAIR).index("trace"), [0, 4, 8]
    place = sum(list(PAIR.values())[:trace])
    return bool(
        (np.abs(pairs[:, diagonal].sum(axis=1) - pairs[:, place]) > ROUNDING * np.abs(pairs).max(initial=0)).any()
    )
