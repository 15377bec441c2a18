"""Note on an equilibrium far from the described pose."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..equilibria.equilibrium import Equilibrium

FAR = 0.2
"""Distance from the described pose, relative to the mechanism's size, above which a note reports it."""


def far_away(dynamics: Dynamics, start: InitialValues, found: Equilibrium) -> Iterator[str]:
    """Yield a note if the equilibrium is far from the described pose, as of a car that has rolled there."""
    system, of_body = dynamics.system, dynamics.system.of_body
    pose = slice(0, of_body.n_q * len(system.bodies))
    places, described = (q[pose].reshape(-1, of_body.n_q)[:, : of_body.linear] for q in (found.q, start.q))
    moved = np.linalg.norm(places - described, axis=1)
    body = int(np.argmax(moved))
    if moved[body] > FAR * system.size:
        yield (
            f"the equilibrium at the start is {moved[body]:.3g} m away from the described pose ({system.bodies[body]}); "
            "if the position matters, as on a road with bumps, describe a pose nearer to the equilibrium"
        )
