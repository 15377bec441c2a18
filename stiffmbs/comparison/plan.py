"""Plan of a comparison: solver configurations, their settings, the error measure, and the repeats."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..describe.model_data import ModelData
from ..describe.scene import Scene
from ..describe.settings import RunSettings
from ..errors import InputError
from ..solve.settings import DEFAULT_POINTS, changed
from .entries import Entry, entries_of
from .measures import measure_of

PER_DECADE = 4
LOOSEST, TIGHTEST = 1e-3, 1e-8
TOLERANCES = tuple(float(f"{10.0**k:.2g}") for k in np.arange(-3, -8.01, -1 / PER_DECADE))
"""Default relative tolerances."""
STEPS = tuple(10.0**k for k in np.arange(-2, -5.1, -1 / PER_DECADE))
"""Default steps of the schemes with fixed steps, in parts of the duration."""
REPEATS = 9
LONGEST_RUN = 20.0
"""Time limit of a run, s."""
LONGER_REFERENCE = 10.0
"""Factor on the time limit for each run of the reference."""
OF_SOLVERS = ("solver", "scheme", "formulation", "rtol", "step")
"""Settings that a comparison varies itself."""


@dataclass(frozen=True)
class Plan:
    """Plan of a comparison.

    Attributes
    ----------
    solvers, formulations : tuple of str
    tolerances : tuple of float
        Relative tolerances, the loosest first.
    steps : tuple of float
        Fixed steps, s, the longest first; empty for parts of the duration.
    measure : str
    repeats : int
    longest : float
        Time limit of a run, s.
    """

    solvers: tuple[str, ...]
    formulations: tuple[str, ...]
    tolerances: tuple[float, ...]
    steps: tuple[float, ...]
    measure: str
    repeats: int
    longest: float

    def entries(self, settings: RunSettings) -> tuple[Entry, ...]:
        """Return the solver configurations; reject a tolerance or step that is invalid for one of them."""
        found = entries_of(self.solvers, self.formulations, settings)
        for entry in found:
            for value in self.values(entry, settings):
                entry.at(settings, value)
        return found

    def values(self, entry: Entry, settings: RunSettings) -> tuple[float, ...]:
        """Return the values of an entry's varied setting, from loose to tight."""
        if entry.varied == "rtol":
            return self.tolerances
        if entry.varied == "step":
            return self.steps or tuple(settings.duration * part for part in STEPS)
        return (0.0,)


def plan_of(
    solvers: Sequence[str], formulations: Sequence[str], tolerances: Sequence[float], steps: Sequence[float],
    measure: str, repeats: int, longest: float,
) -> Plan:  # fmt: skip
    """Return a plan after a check of its numbers.

    Raises
    ------
    InputError
    """
    measure_of(measure)
    for name, value in (("repeats", repeats), ("longest", longest)):
        if not value > 0:
            raise InputError(f"{name}: found {value}, expected more than 0")
    if not len(tolerances):
        raise InputError("tolerances: found none, expected some such as 1e-3, 1e-6")
    return Plan(
        tuple(solvers), tuple(formulations), _loose_first(tolerances), _loose_first(steps), measure, int(repeats),
        float(longest),
    )  # fmt: skip


def _loose_first(values: Sequence[float]) -> tuple[float, ...]:
    return tuple(sorted((float(value) for value in values), reverse=True))


def base_settings(model: ModelData, settings: RunSettings | None, changes: Mapping[str, object]) -> RunSettings:
    """Return the settings of a comparison: the scene's own with changes, and output instants common to all solvers.

    Raises
    ------
    InputError
        If a setting is invalid, or is one that the comparison varies itself.
    """
    own = [name for name in changes if name in OF_SOLVERS]
    if own:
        raise InputError(
            f"{own[0]}: found a setting of one solver, expected it among solvers, formulations, tolerances or steps"
        )
    chosen = changed(settings or (model.run if isinstance(model, Scene) else RunSettings()), dict(changes))
    return changed(chosen, {"points": DEFAULT_POINTS}) if chosen.points == "steps" else chosen
