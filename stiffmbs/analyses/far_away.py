"""Notes on an equilibrium far from the described pose."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..equilibria.equilibrium import Equilibrium
from ..notes import Note, NoteKind

FAR = 0.2
"""Distance from the described pose, relative to the mechanism's size, above which a note reports it."""

BEYOND = 2.0
"""Distance, relative to the mechanism's size, above which the pose is no longer that of the model; a pendulum moves by 2."""


FAR_AWAY = NoteKind(
    "equilibrium-far-away",
    "the equilibrium at the start is {moved:.3g} m away from the described pose ({element})",
    "if the position matters, as on a road with bumps, describe a pose nearer to the equilibrium",
)
BEYOND_ITS_SIZE = NoteKind(
    "equilibrium-beyond-size",
    "{element} is {moved:.3g} m away from the described pose, more than {beyond:g} times the size of the model of {size:.3g} "
    "m: {remedy}",
    "check the stiffnesses, the loads and their units",
)


def far_away(dynamics: Dynamics, start: InitialValues, found: Equilibrium) -> Iterator[Note]:
    """Yield a note if the equilibrium is far from the described pose, as of a car that has rolled there."""
    body, moved = _farthest(dynamics, start, found)
    if moved > FAR * dynamics.system.size:
        yield FAR_AWAY(body, moved=moved)


def beyond_its_size(dynamics: Dynamics, start: InitialValues, found: Equilibrium) -> Iterator[Note]:
    """Yield a note if a body moves by more than twice the size of the mechanism, as on a spring in N/mm that is read as N/m."""
    body, moved = _farthest(dynamics, start, found)
    if moved > BEYOND * dynamics.system.size:
        yield BEYOND_ITS_SIZE(body, moved=moved, beyond=BEYOND, size=dynamics.system.size)


def _farthest(dynamics: Dynamics, start: InitialValues, found: Equilibrium) -> tuple[str, float]:
    """Return the body that is farthest away from the described pose, and its distance, m."""
    system, of_body = dynamics.system, dynamics.system.of_body
    pose = slice(0, of_body.n_q * len(system.bodies))
    places, described = (q[pose].reshape(-1, of_body.n_q)[:, : of_body.linear] for q in (found.q, start.q))
    moved = np.linalg.norm(places - described, axis=1)
    body = int(np.argmax(moved))
    return system.bodies[body], float(moved[body])
