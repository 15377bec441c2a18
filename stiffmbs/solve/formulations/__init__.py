"""Formulations of the residual that the BDF integrator solves, one per file, with the names of Adams."""

from __future__ import annotations

from collections.abc import Callable

from ...compile.formulation import Formulation
from ...model.settings import RunSettings
from .i3 import I3
from .index1 import index1
from .si1 import SI1
from .si2 import SI2, SI2_EXACT

FORMULATIONS: dict[str, Callable[[RunSettings], Formulation]] = {
    "SI2": lambda settings: SI2,
    "SI2_exact": lambda settings: SI2_EXACT,
    "SI1": lambda settings: SI1,
    "I3": lambda settings: I3,
    "index1": lambda settings: index1(settings.stabilisation),
}
"""Formulations by their name in the settings."""
