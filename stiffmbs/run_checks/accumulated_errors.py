"""Accumulated position errors of the steps of a run."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compile.system import System
from ..model.settings import RunSettings
from ..solve.error_control.accumulated_errors import ACCUMULATED
from ..solve.trajectory import Trajectory

AXES = ("x", "y", "z")


def accumulated_errors_sentence(system: System, settings: RunSettings, trajectory: Trajectory) -> Iterator[str]:
    """Yield a sentence on the position with the largest estimated error, if it exceeds a number of tolerances."""
    displaced = trajectory.displaced
    if displaced is None:
        return
    errors = ACCUMULATED.in_tolerances(system, settings, displaced, trajectory.q)
    worst = int(np.nanargmax(errors))
    if not errors[worst] > ACCUMULATED.tolerances:
        return
    what, unit = _position(system, worst)
    yield (
        f"the errors of the steps may add up: {what} may be off by {displaced[worst]:.2g} {unit} by t = {trajectory.t[-1]:.6g} s, "
        f"{errors[worst]:.2g} times the tolerance; choose a smaller rtol, or run with --verify for error bars"
    )


def _position(system: System, velocity: int) -> tuple[str, str]:
    """Return the name of the position that a velocity changes, and its unit."""
    of_body = system.of_body
    body, k = divmod(velocity, of_body.n_u)
    name = system.bodies[body]
    if k < of_body.linear:
        return f"{name}.{AXES[k]}", "m"
    if of_body.dimensions == 2:
        return f"{name}.angle", "rad"
    return f"the rotation of '{name}' about its {AXES[k - of_body.linear]} axis", "rad"
