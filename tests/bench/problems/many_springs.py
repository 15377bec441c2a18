"""A thousand runs of the cart-pendulum, each with another spring, on one thread and on two."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.model.read_scene import read_scene

from ..by_hand import cart_pendulum as hand
from ..many_runs import ManyRuns
from .cart_pendulum import SCENE, TIMES

RTOL = 1e-6


def by_hand(stiffnesses: np.ndarray) -> np.ndarray:
    """The coordinates at the end for each stiffness."""
    return np.array([hand.si2(float(k)).integrate(RTOL, TIMES)[-1, :6] for k in stiffnesses])


BENCHMARKS = (
    ManyRuns("many_springs", partial(read_scene, SCENE), "spring", "stiffness", np.linspace(200, 400, 1000), by_hand),
)
