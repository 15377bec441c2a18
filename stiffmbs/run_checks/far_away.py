"""Check for mechanisms so far from the origin that rounding of coordinates affects the joints."""

from __future__ import annotations

import sys

import numpy as np

from ..compile.system import System
from ..errors import InputError
from .parameters import RUN_CHECKS


def refuse_far_away(system: System) -> None:
    """Refuse joints whose equations are dominated by rounding at the start, which no step size can satisfy.

    Raise an InputError that names the body.
    """
    if not system.n_c:
        return
    of_body = system.of_body
    farthest = np.abs(system.q[: system.n_pose].reshape(-1, of_body.n_q)[:, : of_body.linear]).max(axis=1)
    body = int(np.argmax(farthest))
    rounding, size = farthest[body] * sys.float_info.epsilon, system.size
    if rounding > RUN_CHECKS.coarse * size:
        raise InputError(
            f"bodies.{system.bodies[body]}.position: found {farthest[body]:.3g} m in a mechanism of {size:.3g} m, where neighbouring "
            f"numbers are {rounding:.1g} m apart, expected it nearer to the origin"
        )
