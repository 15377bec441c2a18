"""Simulation whose states are recorded, for channels after its steps."""

from __future__ import annotations

import numpy as np

from ..model.model_data import ModelData
from ..model.settings import RunSettings
from ..notes import Note
from ..results.solution import Solution
from ..solve.settings import IGNORED, settings_notes
from ..solve.stiff_rows import States
from ..solve.trajectory import Outcome
from ..studies.simulation import Simulation
from ..studies.solved_states import solution_of
from ..studies.stepping import FixedSteps
from ..tuning import in_use


class RecordedSimulation(Simulation):
    """Simulation that returns a solution from recorded states."""

    @property
    def data(self) -> ModelData:
        """Return the model with the initial values of the inputs."""
        return self._job.data

    @property
    def settings(self) -> RunSettings:
        """Return the settings of the steps."""
        return self._job.settings

    @property
    def length(self) -> float:
        """Return the length of the implicit step that contains the current time, s; 0 for explicit steps."""
        return self._stepper.length

    def warm_up(self, dt: float) -> None:
        """Take a step as after a breakpoint of an input, whose code is loaded on first use."""
        if isinstance(self._stepper, FixedSteps) and self._job.dynamics.system.has_inputs:
            self._stepper.pass_breakpoints(self.t + dt)
            self._stepper.restart(self.t + dt, self.q, self.u)

    def notes(self) -> list[Note]:
        """Return notes on the settings of the steps; settings that they do not read are those of a run with error control."""
        with in_use(self.settings.tuning):
            notes = settings_notes(self.settings, self._job.dynamics.system)
            return [note for note in notes if note.kind != IGNORED.name]

    def solution(self, t: np.ndarray, states: States, lengths: np.ndarray, outcome: Outcome, message: str) -> Solution:
        """Return the solution from positions and velocities at some instants, between which no input changed.

        `lengths`: values of `length` at these instants, s.
        """
        with in_use(self.settings.tuning):
            return solution_of(self._job, t, states, lengths, self._job.on_constraints, outcome, message, self.notes())
