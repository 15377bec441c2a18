"""Runs of a scene from one communication point to the next."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ...analyses.load_scene import load_scene
from ...describe.scene import Scene
from ...errors import InputError
from ..simulation import Simulation, simulation


class CommunicationSteps:
    """Run with constant inputs between communication points; the integrator keeps its history while they do not change.

    Parameters
    ----------
    path : str or Path

    Raises
    ------
    InputError
        If the scene cannot be read, or has stages.
    """

    def __init__(self, path: str | Path) -> None:
        self._path = path
        self.scene = load_scene(path)
        if self.scene.stages:
            raise InputError("found a scene with stages, expected a scene of one run")
        self._simulation: Simulation | None = None

    def begin(
        self, start: float, parameters: Mapping[str, float], inputs: Mapping[str, float], tolerance: float | None
    ) -> None:
        """Read the scene with other parameters and initial inputs, and discard the previous run."""
        given = [(f"parameters.{name}", repr(value)) for name, value in parameters.items()]
        given += [(f"inputs.{name}", repr(value)) for name, value in inputs.items()]
        settings = [("run.start", repr(start)), *([("run.rtol", repr(tolerance))] if tolerance else [])]
        self.scene = load_scene(self._path, [*given, *settings])
        self._simulation = simulation(self.scene)

    def values(self, inputs: Mapping[str, float]) -> dict[str, float]:
        """Return all channels at the current time, with the given inputs.

        Raises
        ------
        InputError, AssemblyError
            As for `stiffmbs.simulation`.
        """
        running = self._running()
        running.set_inputs(inputs)
        return running.channels

    def step(self, length: float, inputs: Mapping[str, float]) -> None:
        """Advance by a communication step.

        Raises
        ------
        SolverError
            If the end of the step is not reached.
        """
        self._running().step(length, inputs)

    def _running(self) -> Simulation:
        if self._simulation is None:
            self._simulation = simulation(self.scene)
        return self._simulation


def parameters_of(scene: Scene) -> dict[str, float]:
    """Return the numeric parameters of a scene, SI units."""
    return {name: value for name, value in scene.parameters.items() if isinstance(value, float | int)}
