"""Cars on their manoeuvres: the reference cars of the package and that of the examples, on bushings and on ideal joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.analyses.run import solved
from stiffmbs.model.model_data import ModelData
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome

from .error_control import EXAMPLES

SCENES = Path(__file__).parent / "scenes"
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
    "auto": {"solver": "auto"},
}
CONVERGED = 1e-9
OF_REFERENCE = {
    "sweep": {},
    "step": {"parameters.sin_amp": "0", "parameters.steer_amp": "0.01"},
    "bump": {"parameters.sin_amp": "0", "parameters.h_b": "0.05"},
}
OF_EXAMPLE = {
    "sweep": {"choose.manoeuvre": "sine_sweep"},
    "step": {"choose.manoeuvre": "step_steer"},
    "bump": {"choose.manoeuvre": "bump"},
}


@dataclass(frozen=True)
class Car:
    """A scene, and what its manoeuvres change in it.

    Attributes
    ----------
    name : str
    path : Path
    manoeuvres : mapping
        Paths and values of each.
    changes : mapping
        Those of all manoeuvres.
    stiffness : str
        The path of the radial stiffness of the bushings; empty on ideal joints.
    """

    name: str
    path: Path
    manoeuvres: Mapping[str, Mapping[str, str]]
    changes: Mapping[str, str]
    stiffness: str = ""

    def model(self, manoeuvre: str, **changes: str) -> ModelData:
        """The scene of a manoeuvre; further changes of parameters by their names."""
        of_parameters = {f"parameters.{name}": value for name, value in changes.items()}
        return load_scene(self.path, tuple({**self.changes, **self.manoeuvres[manoeuvre], **of_parameters}.items()))


CARS = (
    Car("reference_car_bushings", SCENES / "car_on_bushings.yaml", OF_REFERENCE, {}, "k_r"),
    Car("reference_car_ideal", SCENES / "car_on_ideal_joints.yaml", OF_REFERENCE, {}),
    Car("example_car_bushings", EXAMPLES / "car.yaml", OF_EXAMPLE, {"choose.compliance": "bushing"}, "k_b"),
    Car("example_car_ideal", EXAMPLES / "car.yaml", OF_EXAMPLE, {"choose.compliance": "rigid"}),
)


@dataclass(frozen=True)
class Seen:
    """What errors are taken of, at the output instants: places of bodies (m), and forces of bushings (N), one a column."""

    places: np.ndarray
    forces: np.ndarray

    @classmethod
    def of(cls, model: ModelData, solution: Solution) -> Seen:
        """Those of a solution; of one in the plane without z."""
        axes = "xyz" if model.dimensions == 3 else "xy"
        places = [f"{name}.{axis}" for name in model.bodies for axis in axes]
        bushings = [name for name, force in model.forces.items() if force.type == "bushing"]
        forces = [f"{name}.f{axis}" for name in bushings for axis in axes]
        return cls(*(np.array([solution[name] for name in names]).T for names in (places, forces)))

    def errors(self, exact: Seen) -> dict[str, float]:
        """The largest of places, m, and of forces, relative to the largest of them."""
        found = {"places": float(np.max(np.abs(self.places - exact.places)))}
        if self.forces.size:
            found["forces"] = float(np.max(np.abs(self.forces - exact.forces)) / np.max(np.abs(exact.forces)))
        return found


def seen(model: ModelData, job: Job) -> Seen:
    """What the solution of a job shows; a run that ends early has no place in a benchmark."""
    solution = solved(job)
    if solution.outcome is not Outcome.DONE:
        raise RuntimeError(f"{model.name}: {solution.message}")
    return Seen.of(model, solution)


def converged(model: ModelData, **changes: Any) -> Seen:
    """By bdf at a tight tolerance, as it takes a second at any stiffness; dop853 agrees to the digits that errors are read from."""
    return seen(model, prepare(model, rtol=CONVERGED, **SOLVERS["bdf"], **changes))
