"""A gradient by forward sensitivities beside the run that it belongs to, and beside differences of converged runs."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from stiffmbs.analyses.run import run
from stiffmbs.model.scene import Scene
from stiffmbs.solve.settings import changed
from stiffmbs.studies.case_solver import CaseSolver, Task, written_scene
from stiffmbs.studies.outputs import outputs_of
from stiffmbs.studies.sensitivities.parameters import Parameter, Scenes
from stiffmbs.studies.sensitivities.sensitivities import FINEST, HELD, differentiable, sensitivities

from .benchmark import Row

STEPS, TINY = (2.5e-4, 5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 1.6e-2), 1e-12
"""Steps of the differences, relative to the parameter, and the rtol of their runs: short ones are left to rounding, long ones to the
terms that differences of order 4 leave out."""


@dataclass(frozen=True)
class GradientRuns:
    """The gradient of one output.

    Attributes
    ----------
    name : str
    scene : callable
    parameters : sequence of str
        As for `stiffmbs.sensitivities`.
    output : str
    rounds : int
    """

    name: str
    scene: Callable[[], Scene]
    parameters: Sequence[str]
    output: str
    rounds: int = 5

    def measured(self) -> list[Row]:
        """Run and gradient taking turns; the error is the largest of the derivatives, relative."""
        return self._rows(self.parameters, self.rounds)

    def glanced(self) -> list[Row]:
        """The derivative by one parameter."""
        return self._rows(self.parameters[:1], 1)

    def _rows(self, parameters: Sequence[str], rounds: int) -> list[Row]:
        scene = self.scene()
        found = sensitivities(scene, parameters, self.output)
        error = max(
            abs(found.to[name] / slope - 1.0)
            for name, slope in ((name, self._difference(scene, name)) for name in parameters)
        )
        converged = differentiable(changed(scene.run, {"rtol": FINEST}))
        works: dict[str, Callable[[], Any]] = {
            "as asked": lambda: run(scene),
            "converged": lambda: run(scene, converged),
            "gradient": lambda: sensitivities(scene, parameters, self.output),
        }
        spent: dict[str, list[float]] = {name: [] for name in works}
        for _ in range(rounds):
            for name, work in works.items():
                begun = time.process_time()
                work()
                spent[name].append(time.process_time() - begun)
        median = {name: statistics.median(times) for name, times in spent.items()}
        ratios = " and ".join(f"{median['gradient'] / median[name]:.2f}" for name in ("converged", "as asked"))
        return [
            Row("run", f"rtol {scene.run.rtol:g}", 0.0, median["as asked"], True),
            Row("run", f"rtol {FINEST:g}, which the gradient follows", 0.0, median["converged"], True),
            Row("gradient", f"{len(parameters)} parameters; {ratios} of these runs", error, median["gradient"], False),
        ]

    def _difference(self, scene: Scene, name: str) -> float:
        """The derivative by central differences of order 4: the mean of those by two successive steps that differ least."""
        value = Parameter(Scenes(written_scene(scene)), name).value
        found = [self._central(scene, name, value, step * value) for step in STEPS]
        k = min(range(len(found) - 1), key=lambda k: abs(found[k + 1] - found[k]))
        return 0.5 * (found[k] + found[k + 1])

    def _central(self, scene: Scene, name: str, value: float, h: float) -> float:
        at = [self._value(scene, name, value + k * h) for k in (-2, -1, 1, 2)]
        return (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h)

    def _value(self, scene: Scene, name: str, value: float) -> float:
        (output,) = outputs_of(self.output)
        solver = CaseSolver(Task(written_scene(scene), (name,), {"rtol": TINY, "solver": "bdf", **HELD}, (output,)))
        return float(output.value(solver.solution((value,))))
