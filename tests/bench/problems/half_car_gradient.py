"""The peak force in the half car's front bushing by six parameters."""

from __future__ import annotations

from functools import partial

from stiffmbs.model.read_scene import read_scene

from ..gradients import GradientRuns
from .half_car import SCENE

PARAMETERS = (
    "k_b", "zeta", "V", "bodies.chassis.mass", "forces.front_spring.stiffness", "forces.front_spring.damping",
)  # fmt: skip
BENCHMARKS = (
    GradientRuns(
        "half_car_gradient",
        partial(read_scene, SCENE.replace("STIFFNESS", "1e7")),
        PARAMETERS,
        "peak(front_bushing.fx)",
    ),
)
