"""Compared solver configurations: solvers, schemes and formulations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import InputError
from ..model.settings import RunSettings
from ..reading.did_you_mean import did_you_mean
from ..solve import SOLVERS
from ..solve.explicit.projected import TRAITS as SCHEMES
from ..solve.formulations import FORMULATIONS
from ..solve.settings import changed, traits_of

BDF, PROJECTED, DEFAULT_SCHEME = "bdf", "projected", "dop853"
USUAL = (BDF, DEFAULT_SCHEME, "auto")
"""Solvers that are compared by default."""
EXACT = "kinematic"
KNOWN = (BDF, *SCHEMES, *(name for name in SOLVERS if name not in (BDF, PROJECTED, EXACT)), EXACT)
ALL = "all"


@dataclass(frozen=True)
class Entry:
    """Solver configuration.

    Attributes
    ----------
    settings : mapping of str to object
        Settings that select it.
    varied : str
        Setting that controls its accuracy: ``rtol``, ``step``, or empty.
    implicit, explicit : bool
        Kind of its steps; both are False if it chooses between the kinds, or takes no steps.
    """

    name: str
    settings: Mapping[str, Any]
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


def _entry(name: str, chosen: dict[str, Any], settings: RunSettings) -> Entry:
    traits = traits_of(changed(settings, chosen))
    varied = "" if traits.exact else "step" if traits.fixed_steps else "rtol"
    neither = traits.switches or traits.exact
    return Entry(name, chosen, varied, traits.implicit and not neither, not traits.implicit and not neither)
