"""Models in a loop of Python: a call for each step with new inputs, and channels read after it."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

import stiffmbs
from stiffmbs.model.model_data import ModelData
from stiffmbs.studies.simulation import Simulation
from stiffmbs.studies.stepping import ImplicitSteps

from ..benchmark import Row

SCHEMES: dict[str, dict[str, Any]] = {
    "rk4": {"solver": "projected", "scheme": "rk4"},
    "euler_cromer": {"solver": "projected", "scheme": "euler_cromer"},
    "linearly_implicit_euler": {"solver": "projected", "scheme": "linearly_implicit_euler"},
    "extrapolated_euler": {"solver": "projected", "scheme": "extrapolated_euler"},
    "bdf": {"solver": "bdf"},
    "radau": {"solver": "radau"},
}
CHECKED = 50
"""Steps over which states are compared with those of exact steps."""
EXACT = {"solver": "projected", "scheme": "dop853", "rtol": 1e-11}


@dataclass(frozen=True)
class InTheLoop:
    """A model whose inputs are all new at each step.

    Attributes
    ----------
    name : str
    model : callable
        The model, or the path of an MJCF file, which MuJoCo steps too if it is installed.
    inputs : tuple of str
    size : float
        Largest input.
    least : float
        Smallest input.
    schemes : tuple of str
    step : float
        s.
    steps, rounds : int
    """

    name: str
    model: Callable[[], ModelData | Path]
    inputs: tuple[str, ...]
    size: float
    step: float = 1e-3
    steps: int = 2000
    rounds: int = 5
    least: float = 0.0
    schemes: tuple[str, ...] = tuple(SCHEMES)

    def measured(self) -> list[Row]:
        """Medians over rounds, by the processor's time; errors are those of joint coordinates, or of bodies without joints, after some steps."""
        model, values = self.model(), self._values()
        exact = self._after(self._simulation(model, EXACT), values)
        rows = []
        for scheme in self.schemes:
            settings = SCHEMES[scheme]
            sim = self._simulation(model, settings)
            off = float(np.abs(self._after(sim, values) - exact).max())
            how = f"a call for each step, arrays of joints read{_evaluations(sim, self.step, values)}"
            rows += [
                self._row(scheme, how, off, partial(_arrays, sim, self.step, values)),
                self._row(scheme, "ten channels read by name", off, partial(_by_name, sim, self.step, values)),
            ]
        if "rk4" in self.schemes:
            together = self._simulation(model, SCHEMES["rk4"])
            rows.append(self._row("rk4", "all steps in one call", 0.0, partial(_together, together, self.step, values)))
        if isinstance(model, Path) and find_spec("mujoco"):
            rows.append(
                self._row("mujoco rk4", "a call for each step, arrays read", *_mujoco(model, values, exact), peer=True)
            )
        return rows

    def glanced(self) -> list[Row]:
        """A few steps."""
        return replace(self, steps=100, rounds=1).measured()

    def _values(self) -> np.ndarray:
        part = np.random.default_rng(0).random((self.steps, len(self.inputs)))
        return self.least + (self.size - self.least) * part

    def _simulation(self, model: ModelData | Path, settings: dict[str, Any]) -> Simulation:
        fixed: dict[str, Any] = {"step": self.step} if settings.get("scheme", "dop853") != "dop853" else {}
        return stiffmbs.simulation(model, inputs=dict.fromkeys(self.inputs, self.least), **settings, **fixed)

    def _after(self, sim: Simulation, values: np.ndarray) -> np.ndarray:
        for row in values[:CHECKED]:
            sim.step(self.step, row)
        return sim.joint_coordinates if sim.joints else sim.q

    def _row(self, solver: str, how: str, off: float, take: Callable[[], object], peer: bool = False) -> Row:
        spent = []
        for _ in range(self.rounds):
            begun = time.process_time()
            take()
            spent.append(time.process_time() - begun)
        seconds = statistics.median(spent)
        return Row(solver, f"{how}: {1e6 * seconds / self.steps:.1f} us a step", off, seconds, peer)


def _evaluations(sim: Simulation, step: float, values: np.ndarray) -> str:
    """Return a clause on the residuals and matrices of some implicit steps; empty for explicit steps."""
    if not isinstance(sim._stepper, ImplicitSteps):
        return ""
    spent = []
    for row in values[:CHECKED]:
        sim.step(step, row)
        counted = sim._stepper._started._engine.ida.counters.counted()
        spent.append(counted["residuals"] + counted["jacobians"])
    return f", {np.mean(spent):.0f} evaluations, {max(spent)} at most"


def _arrays(sim: Simulation, step: float, values: np.ndarray) -> None:
    sim.reset()
    for row in values:
        sim.step(step, row)
        sim.joint_coordinates, sim.joint_rates  # noqa: B018


def _by_name(sim: Simulation, step: float, values: np.ndarray) -> None:
    names = [name + ending for ending in ("", "_rate") for name in sim.joints][:10]
    sim.reset()
    for row in values:
        sim.step(step, row)
        for name in names:
            sim[name]


def _together(sim: Simulation, step: float, values: np.ndarray) -> None:
    sim.reset()
    sim.steps(len(values), values, step)


def _mujoco(path: Path, values: np.ndarray, exact: np.ndarray) -> tuple[float, Callable[[], object]]:
    """Return the error of joint coordinates after some steps, and a function that takes all steps."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path))

    def take(rows: np.ndarray = values) -> np.ndarray:
        data = mujoco.MjData(model)
        for row in rows:
            data.ctrl[:] = row
            mujoco.mj_step(model, data)
            data.qpos.copy(), data.qvel.copy()
        return np.array(data.qpos)

    return float(np.abs(take(values[:CHECKED]) - exact).max()), take
