"""Methods of models, reports and solutions that other packages implement.

Each method calls the function of the package with its name, as a user's program does: the packages that define these
classes import none of the packages that use them.  `self` is ``Any`` because the classes are defined there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Unpack

import stiffmbs

from .model.settings import RunSettings, Settings, SteadyMotion, takes_settings

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure as Sheet

    from .analyses.check import Report
    from .analyses.equilibrium import EquilibriumFound
    from .analyses.given_inputs import Given
    from .analyses.linearised.modes import Modes
    from .analyses.start_from import StartFrom
    from .results.solution import Solution
    from .studies.simulation import Simulation


class NotebookMethods:
    """Representation in notebooks."""

    def _repr_html_(self) -> str:
        return stiffmbs.html(self)


class CampbellMethods(NotebookMethods):
    """Text and figure of modes over a parameter."""

    def table(self: Any, orders: Sequence[float] | None = None) -> str:
        """Return the frequencies and damping ratios at both ends, critical speeds and limits of stability as text.

        Parameters
        ----------
        orders : sequence of float, optional
            As for `plot`.
        """
        from .show.campbell import campbell_text

        return campbell_text(self, orders)

    def plot(self: Any, orders: Sequence[float] | None = None, highest: float | None = None) -> Sheet:
        """Draw the Campbell diagram: frequencies and damping ratios over the parameter (needs matplotlib, the extra ``plot``).

        Parameters
        ----------
        orders : sequence of float, optional
            Multiples of the parameter that are drawn as lines; by default 1 if its unit is that of an angular velocity.
        highest : float, optional
            Highest frequency that is shown, Hz; by default a little above the lines.
        """
        from .show.campbell import campbell_figure

        return campbell_figure(self, orders, highest)

    def __str__(self) -> str:
        return self.table()


class ModelMethods(NotebookMethods):
    """Analyses and drawings of a model."""

    @takes_settings
    def run(
        self: Any,
        settings: RunSettings | None = None,
        watch: Callable[[float], None] | None = None,
        start_from: StartFrom | None = None,
        inputs: Mapping[str, Given] | None = None,
        **changes: Unpack[Settings],
    ) -> Solution:
        """Solve the model; parameters, result and errors are those of `stiffmbs.run`."""
        return stiffmbs.run(self, settings, watch, start_from, inputs, **changes)

    @takes_settings
    def verify(
        self: Any,
        settings: RunSettings | None = None,
        watch: Callable[[float], None] | None = None,
        start_from: StartFrom | None = None,
        **changes: Unpack[Settings],
    ) -> Solution:
        """Solve the model and estimate errors; parameters, result and errors are those of `stiffmbs.verify`."""
        return stiffmbs.verify(self, settings, watch, start_from, **changes)

    @takes_settings
    def equilibrium(
        self: Any,
        settings: RunSettings | None = None,
        start_from: StartFrom | None = None,
        motion: SteadyMotion | None = None,
        **changes: Unpack[Settings],
    ) -> EquilibriumFound:
        """Find an equilibrium or a steady motion; parameters, result and errors are those of `stiffmbs.equilibrium`."""
        return stiffmbs.equilibrium(self, settings, start_from, motion, **changes)

    @takes_settings
    def simulation(
        self: Any,
        inputs: Mapping[str, float] | None = None,
        settings: RunSettings | None = None,
        **changes: Unpack[Settings],
    ) -> Simulation:
        """Prepare a step-by-step solution; parameters, result and errors are those of `stiffmbs.simulation`."""
        return stiffmbs.simulation(self, inputs, settings, **changes)

    @takes_settings
    def modes(
        self: Any,
        settings: RunSettings | None = None,
        at: float | None = None,
        start_from: StartFrom | None = None,
        **changes: Unpack[Settings],
    ) -> Modes:
        """Return frequencies, damping and mode shapes; parameters, result and errors are those of `stiffmbs.modes`."""
        return stiffmbs.modes(self, settings, at, start_from, **changes)

    @takes_settings
    def check(self: Any, settings: RunSettings | None = None, **changes: Unpack[Settings]) -> Report:
        """Check degrees of freedom and redundancy; parameters, result and errors are those of `stiffmbs.check`."""
        return stiffmbs.check(self, settings, **changes)

    def draw(
        self: object, path: str | Path | None = None, at: float | None = None, described: bool = False, checked: bool = False,
        view: str = "", names: bool = True, forces: bool | None = None,
    ) -> Sheet | None:  # fmt: skip
        """Draw the model at a given time; parameters, result and errors are those of `stiffmbs.draw`."""
        return stiffmbs.draw(self, path, at, described, checked, view, names, forces)


class SolutionMethods(NotebookMethods):
    """Text and plots of a solution."""

    def summary(self: Any, all: bool = False) -> str:
        """Return what ``stiffmbs run`` prints; parameters and result are those of `stiffmbs.summary`."""
        return stiffmbs.summary(self, all)

    def plot(self: Any, *channels: str, x: str = "time", z: str = "", title: str = "", equal: bool = False) -> Sheet:
        """Plot channels; parameters, result and errors are those of `stiffmbs.plot`."""
        return stiffmbs.plot(self, *channels, x=x, z=z, title=title, equal=equal)
