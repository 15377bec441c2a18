"""The choice between the implicit and the explicit integrator, by the spectrum of the scene."""

from __future__ import annotations

import numpy as np

from ..compile.system import PLANAR
from ..describe.settings import RunSettings
from .mechanics import Mechanics
from .spectrum import spectrum

STIFF = 60.0
"""Ratio of the fastest rate to that of the motion from which the implicit integrator pays: an explicit step of order 8
goes as far as 5.6 over the fastest rate and costs about three steps of BDF, which takes some 30 per unit of the motion
(measured on the half-car, where their times meet at 1e6 N/m in the bushings)."""
MOST_VELOCITIES = 900
"""Velocities up to which the dense spectrum costs less than what a wrong choice would."""


def choose(mechanics: Mechanics, settings: RunSettings, t: float) -> tuple[RunSettings, str]:
    """The settings with a solver in place of ``auto``, and the reason in one line.

    An explicit method follows the fastest vibration whether it matters or not; an implicit one follows what the
    tolerance asks for.  Events and friction, whose corners ask for many restarts, go to ``bdf`` too.

    Returns
    -------
    RunSettings, str
    """
    system = mechanics.system
    if system.n_values("switch"):
        return _with(settings, "bdf"), "auto chose bdf: the scene has contacts or other corners in its state"
    if system.n_u > MOST_VELOCITIES:
        return _with(settings, "bdf"), f"auto chose bdf: {system.n_u} velocities are too many for a dense spectrum"
    found = spectrum(mechanics, t)
    motion = max(found.slowest, _rate_of_motion(mechanics, t), 1.0 / settings.duration)
    ratio = found.fastest / motion
    facts = (
        f"the fastest rate is {found.fastest:.3g} 1/s (damping ratio {found.damping:.2g}), "
        f"{ratio:.3g} times that of the motion"
    )
    if ratio > STIFF:
        return _with(settings, "bdf"), f"auto chose bdf: {facts}, so the scene is stiff"
    return _with(settings, "projected"), f"auto chose projected dop853: {facts}, so the scene is not stiff"


def _with(settings: RunSettings, solver: str) -> RunSettings:
    return settings.model_copy(update={"solver": solver, "scheme": "dop853"})


def _rate_of_motion(mechanics: Mechanics, t: float) -> float:
    """How fast the coordinates change at the start for their size, 1/s."""
    u, acceleration = mechanics.state.u, mechanics.accelerate(t)[1]
    size = max(mechanics.system.size, 1e-300)
    speeds = np.abs(u) / np.tile([size, size, 1.0], len(u) // PLANAR)
    pulls = np.abs(acceleration) / np.tile([size, size, 1.0], len(u) // PLANAR)
    return float(max(speeds.max(initial=0.0), np.sqrt(pulls.max(initial=0.0))))
