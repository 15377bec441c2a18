"""Initial values and integrators. They work on a `System` and know no kinds of element."""

from __future__ import annotations

from dataclasses import replace

from ..model.settings import RunSettings
from .solver import Traits, loaded_when_used

READ_BY_FORMULATIONS = {"index1": ("stabilisation",)}
"""Settings that a formulation reads."""


def _implicit(name: str, *own: str, settings: RunSettings) -> Traits:
    of_formulation = READ_BY_FORMULATIONS.get(settings.formulation, ())
    return Traits(name, ("formulation", "rtol", "atol", "max_step", *own, *of_formulation), implicit=True)


def of_bdf(settings: RunSettings) -> Traits:
    """Return the traits of BDF with a formulation, which may read further settings."""
    return _implicit("bdf", "max_order", settings=settings)


def of_radau(settings: RunSettings) -> Traits:
    """Return the traits of Radau methods with a formulation, which may read further settings."""
    return _implicit("radau", "stages", settings=settings)


def of_auto(settings: RunSettings) -> Traits:
    """Return the traits of `bdf` and `radau`. The settings of the explicit scheme, projected `dop853`, are among them."""
    reads = dict.fromkeys((*of_bdf(settings).reads, *of_radau(settings).reads))
    return replace(of_bdf(settings), name="auto", reads=tuple(reads), switches=True)


SOLVERS = {
    "auto": loaded_when_used(".auto", __name__, of_auto),
    "bdf": loaded_when_used(".bdf", __name__, of_bdf),
    "radau": loaded_when_used(".radau.radau", __name__, of_radau),
    "projected": loaded_when_used(".explicit.projected", __name__),
    "kinematic": loaded_when_used(".kinematic", __name__),
}
"""Solvers by their name in the settings. A new solver needs an entry here and its name in `SolverName` (`stiffmbs.solver_names`)."""
