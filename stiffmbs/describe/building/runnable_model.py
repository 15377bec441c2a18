"""Analyses of a model as methods; each calls the function of the package with its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Unpack

from ..settings import RunSettings, Settings, SteadyMotion, takes_settings
from .model_builder import Body, BodyHandle, Data, ModelBuilder

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure as Sheet

    from ...analyses.check import Report
    from ...analyses.equilibrium import EquilibriumFound
    from ...analyses.given_inputs import Given
    from ...analyses.linearised.modes import Modes
    from ...analyses.start_from import StartFrom
    from ...results.solution import Solution
    from ...studies.simulation import Simulation


class RunnableModel(ModelBuilder[Data, Body, BodyHandle]):
    """Model that can be solved, analysed and drawn."""

    def _repr_html_(self) -> str:
        from ...show.html import model_html

        return model_html(self)

    @takes_settings
    def run(
        self,
        settings: RunSettings | None = None,
        watch: Callable[[float], None] | None = None,
        start_from: StartFrom | None = None,
        inputs: Mapping[str, Given] | None = None,
        **changes: Unpack[Settings],
    ) -> Solution:
        """Solve the model; parameters, result and errors are those of `stiffmbs.run`."""
        from ...analyses.run import run

        return run(self, settings, watch, start_from, inputs, **changes)

    @takes_settings
    def verify(
        self,
        settings: RunSettings | None = None,
        watch: Callable[[float], None] | None = None,
        start_from: StartFrom | None = None,
        **changes: Unpack[Settings],
    ) -> Solution:
        """Solve the model and estimate errors; parameters, result and errors are those of `stiffmbs.verify`."""
        from ...verification.verify import verify

        return verify(self, settings, watch, start_from, **changes)

    @takes_settings
    def equilibrium(
        self,
        settings: RunSettings | None = None,
        start_from: StartFrom | None = None,
        motion: SteadyMotion | None = None,
        **changes: Unpack[Settings],
    ) -> EquilibriumFound:
        """Find an equilibrium or a steady motion; parameters, result and errors are those of `stiffmbs.equilibrium`."""
        from ...analyses.equilibrium import equilibrium

        return equilibrium(self, settings, start_from, motion, **changes)

    @takes_settings
    def simulation(
        self,
        inputs: Mapping[str, float] | None = None,
        settings: RunSettings | None = None,
        **changes: Unpack[Settings],
    ) -> Simulation:
        """Prepare a step-by-step solution; parameters, result and errors are those of `stiffmbs.simulation`."""
        from ...studies.simulation import simulation

        return simulation(self, inputs, settings, **changes)

    @takes_settings
    def modes(
        self,
        settings: RunSettings | None = None,
        at: float | None = None,
        start_from: StartFrom | None = None,
        **changes: Unpack[Settings],
    ) -> Modes:
        """Return frequencies, damping and mode shapes; parameters, result and errors are those of `stiffmbs.modes`."""
        from ...analyses.linearised.modes import modes

        return modes(self, settings, at, start_from, **changes)

    @takes_settings
    def check(self, settings: RunSettings | None = None, **changes: Unpack[Settings]) -> Report:
        """Check degrees of freedom and redundancy; parameters, result and errors are those of `stiffmbs.check`."""
        from ...analyses.check import check

        return check(self, settings, **changes)

    def draw(
        self, path: str | Path | None = None, at: float | None = None, described: bool = False, checked: bool = False,
        view: str = "", names: bool = True, forces: bool = True,
    ) -> Sheet | None:  # fmt: skip
        """Draw the model at a given time; parameters, result and errors are those of `stiffmbs.draw`."""
        from ...show.drawing.draw import draw

        return draw(self, path, at, described, checked, view, names, forces)
