"""How often confidence intervals of fitted parameters hold the truth."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.model.read_scene import read_scene
from stiffmbs.reading.variation import Range
from stiffmbs.studies.fit import fit

from .benchmark import Row


@dataclass(frozen=True)
class IntervalRuns:
    """Fits of one model to many noisy data sets.

    Attributes
    ----------
    name : str
    scene : str
        With the true values of its parameters.
    parameters : mapping of str to Range
        What is fitted.
    noise : mapping of str to float
        The channels that are measured, and the standard deviation of each.
    data_sets : int
    """

    name: str
    scene: str
    parameters: Mapping[str, Range]
    noise: Mapping[str, float]
    data_sets: int = 100

    def measured(self) -> list[Row]:
        """All data sets; the error is the largest one of a fitted value, relative."""
        return self._rows(self.data_sets)

    def glanced(self) -> list[Row]:
        """A few of them."""
        return self._rows(3)

    def _rows(self, count: int) -> list[Row]:
        scene = read_scene(self.scene)
        true, truth = run(scene), {name: float(scene.parameters[name]) for name in self.parameters}
        held, off, begun = dict.fromkeys(truth, 0), dict.fromkeys(truth, 0.0), time.process_time()
        for seed in range(count):
            chance = np.random.default_rng(seed)
            data = {"time": true.time}
            data |= {name: true[name] + chance.normal(0.0, sigma, len(true.time)) for name, sigma in self.noise.items()}
            found = fit(scene, data, self.parameters)
            for name, value in truth.items():
                low, high = found.intervals[name]
                held[name] += low <= value <= high
                off[name] = max(off[name], abs(found.values[name] / value - 1.0))
        each = (time.process_time() - begun) / count
        return [
            Row("fit", f"{name} within its 95 % interval in {held[name]} of {count}", off[name], each, False)
            for name in truth
        ]
