"""A thousand half cars, each with other bushings, by a study on one thread and on two."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.model.read_scene import read_scene

from ..studies import StudyRuns
from .half_car import SCENE

BENCHMARKS = (
    StudyRuns(
        "half_car_study",
        partial(read_scene, SCENE.replace("STIFFNESS", "1e7")),
        {"k_b": np.logspace(6, 7.5, 1000), "rtol": 1e-8},
        "peak(front_bushing.fx)",
    ),
)
