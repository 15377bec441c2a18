"""Plan of a comparison: solver configurations, their settings, the error measure, and the repeats."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real

import numpy as np

from ..analyses.job import settings_of
from ..errors import InputError, refuse_text
from ..model.model_data import ModelData
from ..model.settings import DEFAULT_POINTS, RunSettings
from ..reading.did_you_mean import did_you_mean
from ..reading.variation import Range, Variation, numbers_of, variation
from ..solve import SOLVERS
from ..solve.explicit.projected import TRAITS as SCHEMES
from ..solve.formulations import FORMULATIONS
from ..solve.settings import changed, traits_of
from .measures import measure_of

BDF, PROJECTED, DEFAULT_SCHEME = "bdf", "projected", "dop853"
USUAL = (BDF, DEFAULT_SCHEME, "auto")
"""Solvers that are compared by default."""
EXACT = "kinematic"
KNOWN = (BDF, *SCHEMES, *(name for name in SOLVERS if name not in (BDF, PROJECTED, EXACT)), EXACT)
ALL = "all"


@dataclass(frozen=True)
class Entry:
    """Solver configuration.

    `settings`: settings that select it. `varied`: setting that controls its accuracy: ``rtol``, ``step``, or empty.
    `implicit`, `explicit`: kind of its steps; both are False if it chooses between the kinds, or takes no steps.
    """

    name: str
    settings: Mapping[str, object]
    varied: str
    implicit: bool
    explicit: bool

    @property
    def chooses(self) -> bool:
        """Return True if it chooses between other solvers."""
        return bool(self.varied) and not self.implicit and not self.explicit

    def at(self, settings: RunSettings, value: float) -> RunSettings:
        """Return the settings of a run; an absolute tolerance stays in proportion to the relative one."""
        changes = {**self.settings, **({self.varied: value} if self.varied else {})}
        if self.varied == "rtol" and settings.atol:
            changes["atol"] = settings.atol * value / settings.rtol
        return changed(settings, changes)

    def setting(self, value: float) -> str:
        """Return the setting as text: ``rtol 1e-05``."""
        return f"{self.varied} {value:.3g}" if self.varied else "exact"


def entries_of(solvers: Sequence[str], formulations: Sequence[str], settings: RunSettings) -> tuple[Entry, ...]:
    """Return the requested solver configurations.

    `solvers`: ``bdf``, ``auto``, ``kinematic``, schemes of `projected`, or ``all``, which is all but ``kinematic``.
    `formulations`: formulations of bdf; by default that of the settings. Raises InputError if a name is unknown, or
    formulations are given without bdf among the solvers.
    """
    names = [name for given in solvers for name in (KNOWN[:-1] if given == ALL else [given])]
    names = [DEFAULT_SCHEME if name == PROJECTED else name for name in dict.fromkeys(names)]
    wrong = [name for name in names if name not in KNOWN]
    if wrong or not names:
        near = did_you_mean(wrong[0], KNOWN) if wrong else ""
        raise InputError(f"solvers: found '{', '.join(wrong)}'{near}, expected some of {', '.join(KNOWN)}, or {ALL}")
    for formulation in formulations:
        if formulation not in FORMULATIONS:
            near = did_you_mean(formulation, FORMULATIONS)
            raise InputError(f"formulations: found '{formulation}'{near}, expected some of {', '.join(FORMULATIONS)}")
    if formulations and BDF not in names:
        raise InputError(f"formulations: found {', '.join(formulations)} without bdf, expected bdf among the solvers")
    return tuple(entry for name in names for entry in _entries(name, tuple(dict.fromkeys(formulations)), settings))


def _entries(name: str, formulations: Sequence[str], settings: RunSettings) -> list[Entry]:
    if name in SCHEMES:
        return [_entry(name, {"solver": PROJECTED, "scheme": name}, settings)]
    if name != BDF or not formulations:
        return [_entry(name, {"solver": name}, settings)]
    many = len(formulations) > 1
    return [
        _entry(f"{name} {formulation}" if many else name, {"solver": name, "formulation": formulation}, settings)
        for formulation in formulations
    ]


def _entry(name: str, chosen: dict[str, object], settings: RunSettings) -> Entry:
    traits = traits_of(changed(settings, chosen))
    varied = "" if traits.exact else "step" if traits.fixed_steps else "rtol"
    neither = traits.switches or traits.exact
    return Entry(name, chosen, varied, traits.implicit and not neither, not traits.implicit and not neither)


PER_DECADE = 4
Values = str | Range | Variation | Sequence[float]
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

    `tolerances`: relative tolerances, the loosest first. `steps`: fixed steps, s, the longest first; empty for parts of
    the duration. `longest`: time limit of a run, s.
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
    solvers: Sequence[str], formulations: Sequence[str], tolerances: Values, steps: Values | None, measure: str,
    repeats: int, longest: float,
) -> Plan:  # fmt: skip
    """Return a plan after a check of its numbers."""
    refuse_text("solvers", solvers, "solvers")
    refuse_text("formulations", formulations, "formulations")
    measure_of(measure)
    for name, value in (("repeats", repeats), ("longest", longest)):
        if not (isinstance(value, Real) and value > 0):
            raise InputError(f"{name}: found {value!r}, expected a number, more than 0")
    loose_first = numbers_of(variation("tolerances", tolerances), PER_DECADE)[::-1]
    steps_first = numbers_of(variation("steps", steps), PER_DECADE)[::-1] if steps is not None else ()
    return Plan(
        tuple(solvers), tuple(formulations), loose_first, steps_first, measure, int(repeats), float(longest)
    )  # fmt: skip


def base_settings(model: ModelData, settings: RunSettings | None, changes: Mapping[str, object]) -> RunSettings:
    """Return the settings of a comparison: the scene's own with changes, and output instants common to all solvers.

    Raises InputError if a setting is invalid, or is one that the comparison varies itself.
    """
    own = [name for name in changes if name in OF_SOLVERS]
    if own:
        raise InputError(
            f"{own[0]}: found a setting of one solver, expected it among solvers, formulations, tolerances or steps"
        )
    chosen = settings_of(model, settings, changes)
    return changed(chosen, {"points": DEFAULT_POINTS}) if chosen.points == "steps" else chosen
