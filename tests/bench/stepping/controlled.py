"""A controlled model solved step by step, beside the same integration without Python between the steps."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.renumber import changes_of_numbers
from stiffmbs.compile.machine.routines import Routine
from stiffmbs.errors import SolverError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.studies.case_solver import CaseSolver, Task, written_scene
from stiffmbs.studies.simulation import Simulation, simulation
from stiffmbs.studies.stepping import StartedSteps

from ..benchmark import Row

IN_A_ROW = Routine("tests.bench.native.restarts", "restarts_in_a_row", "int64(int64, float64, float64*, float64*, int64*)")  # fmt: skip


@dataclass(frozen=True)
class Stepping:
    """A model with one input and a controller.

    Attributes
    ----------
    name : str
    scene : str
        Text of a scene.
    input : str
        The parameter that one number of a force is.
    control : callable
        The input's value at two measured numbers.
    measured_channels : tuple of str
        Coordinates or velocities of bodies, which these are.
    reference : callable
        The first of them after each step, given dt and the number of steps.
    dt : float
        s.
    steps : int
    rounds : int
    """

    name: str
    scene: str
    input: str
    control: Callable[[float, float], float]
    measured_channels: tuple[str, str]
    reference: Callable[[float, int], np.ndarray]
    dt: float = 1e-3
    steps: int = 10_000
    rounds: int = 5

    def measured(self) -> list[Row]:
        """Both taking turns, by the processor's time; errors are those of the first channel."""
        return self._rows()

    def glanced(self) -> list[Row]:
        """A few steps."""
        return replace(self, steps=100, rounds=1)._rows()

    def _rows(self) -> list[Row]:
        sim = simulation(read_scene(self.scene), inputs={self.input: 0.0})
        places, inputs = self._stepped(sim)
        expected = self.reference(self.dt, self.steps)
        alone = _Alone(self.scene, self.input)
        spent: dict[str, list[float]] = {"alone": [], "stepped": []}
        for _ in range(self.rounds):
            spent["alone"].append(alone.seconds(self.dt, inputs))
            sim.reset()
            begun = time.process_time()
            self._stepped(sim)
            spent["stepped"].append(time.process_time() - begun)
        own, whole = (statistics.median(times) for times in spent.values())
        each, above = (1e6 * seconds / self.steps for seconds in (whole, whole - own))
        off = float(np.max(np.abs(places - expected)))
        return [
            Row("integrator", f"{self.steps} starts and their steps in one compiled loop", off, own, True),
            Row("simulation", f"{each:.1f} us a step, {above:.1f} above the integrator's", off, whole, False),
        ]

    def _stepped(self, sim: Simulation) -> tuple[np.ndarray, np.ndarray]:
        """The first channel after each step, and the inputs."""
        places, inputs = np.empty(self.steps), np.empty(self.steps)
        place, velocity = self.measured_channels
        for k in range(self.steps):
            value = self.control(sim[place], sim[velocity])
            sim.step(self.dt, inputs={self.input: value})
            places[k], inputs[k] = sim[place], value
        return places, inputs


class _Alone:
    """The integrator of a simulation, with the number that its input is."""

    def __init__(self, text: str, parameter: str) -> None:
        solver = CaseSolver(Task(written_scene(read_scene(text)), (parameter,), {}, ()))
        self._job = prepare(solver.scene([0.0]))
        self._q, self._u = self._job.start.q.copy(), self._job.start.u.copy()
        self._steps = StartedSteps(self._job, self._q, self._u)
        (change,) = changes_of_numbers(self._job, solver.scene([1.0])) or []
        present = change.group.numbers[change.first :][: len(change.values)]
        (place,) = np.flatnonzero(change.values != present)
        self._number = change.group.numbers[change.first + int(place) :]

    def seconds(self, dt: float, inputs: np.ndarray) -> float:
        """Time that the starts and steps with these inputs take."""
        self._q[:], self._u[:] = self._job.start.q, self._job.start.u
        in_a_row, restarts = IN_A_ROW.call, self._steps._engine._starts
        if restarts is None:
            raise SolverError("found a model that compiled starts do not serve, expected one without events")
        self._job.dynamics.state.q[:], self._job.dynamics.state.u[:] = self._q, self._u
        begun = time.process_time()
        done = in_a_row(len(inputs), dt, inputs.ctypes.data, self._number.ctypes.data, restarts.table)
        spent = time.process_time() - begun
        if done < len(inputs):
            raise SolverError(f"the integrator by itself: stopped after {done} of {len(inputs)} steps")
        return spent
