"""Laws with features that no list of functions holds, narrower than a step: error bars must hold the true error.

High powers of cosines and parabolas are bumps without an edge.  A body that passes one gains m (v1^2 - v0^2)/2, the
integral of the force over its way, by quadrature of the formula.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model import spatial_model as spatial
from stiffmbs.model.model import Model
from stiffmbs.verification.verify import verify

from ...case import Case, Outcome, Verdict

OverTheWay = Callable[[np.ndarray], np.ndarray]
"""A quantity at each place of the way."""
PLACES = 2_000_001
"""At which forces are integrated, over 10 m or rad."""
WORTH_A_WORD = 1e-3
"""Relative error of a speed above which words must go with it."""


def flying(force: str) -> Model:
    """1 kg at 10 m/s under a force over its way."""
    model = Model("Bump")
    model.add("body", Body(mass=1, inertia=1, velocity=(10, 0)))
    model.add("push", FORCES["force"](i="body", force=(force, 0)))
    return model


def turning(torque: str) -> Model:
    """1 kg m^2 on a pin at 10 rad/s under a torque over its angle."""
    model = Model("Turning bump")
    model.add("wheel", Body(mass=1, inertia=1, omega=10))
    model.add("pin", JOINTS["revolute"](i="wheel", j="ground"))
    model.add("push", FORCES["torque"](i="wheel", torque=torque))
    return model


def in_space(force: str) -> spatial.Model:
    """1 kg at 10 m/s along z under a force over its way."""
    model = spatial.Model("Bump in space")
    model.add("body", spatial.Body(mass=1, inertia=(1, 1, 1), velocity=(0, 0, 10)))
    model.add("push", spatial.FORCES["force"](i="body", force=(0, 0, force)))
    return model


def faster(force: OverTheWay) -> float:
    """The speed behind a force over the way, m/s."""
    return float(np.sqrt(100 + 2 * _integrated(force)))


def slower(damping: OverTheWay) -> float:
    """The speed behind a damping over the way, N s/m: m v' = -c(x) v."""
    return float(10 - _integrated(damping))


def _integrated(quantity: OverTheWay) -> float:
    way = np.linspace(0, 10, PLACES)
    return float(np.trapezoid(quantity(way), way))


def _judged(
    scene: Callable[[], Model | spatial.Model], channel: str, speed: Callable[[], float], how: dict[str, Any]
) -> Verdict:
    solution, expected = verify(scene(), duration=1.0, points=14, **how), speed()
    error = abs(float(solution[channel][-1]) - expected)
    bar = solution.errors[channel].over_time if channel in solution.errors else np.nan
    notes = "; ".join(solution.notes)
    if error > bar:
        return Verdict(Outcome.WRONG, error, float(bar), f"outside its bar; {notes}")
    if error > WORTH_A_WORD * expected and "max_step" not in notes:
        return Verdict(Outcome.WRONG, error, float(bar), f"no word of max_step; {notes}")
    return Verdict(Outcome.RIGHT, error, float(bar), notes)


def _case(
    name: str, scene: Callable[[], Model | spatial.Model], channel: str, speed: Callable[[], float], **how: Any
) -> Case:
    what = "speed behind a bump within its bar, against quadrature of the force; words where it is wrong"
    return Case(name, what, partial(_judged, scene, channel, speed, how))


_NARROW, _COSINE, _PARABOLA = (
    "cos(({} - 5.2371)/3)^20000000",
    "cos(({} - 5.2371)/4)^20000000",
    "(1 - (({} - 5.2371)/8)^2)^10000000",
)


def _narrow(way: np.ndarray) -> np.ndarray:
    return np.cos((way - 5.2371) / 3) ** 20_000_000


def _cosine(way: np.ndarray) -> np.ndarray:
    return np.cos((way - 5.2371) / 4) ** 20_000_000


def _parabola(way: np.ndarray) -> np.ndarray:
    return (1 - ((way - 5.2371) / 8) ** 2) ** 10_000_000


CASES = (
    _case(
        "bump as a power of a cosine", partial(flying, f"1e4*{_NARROW.format('body.x')}"), "body.vx", partial(faster, lambda way: 1e4 * _narrow(way)), solver="bdf",
    ),
    _case(
        "bump as a power of a cosine, explicit", partial(flying, f"1e4*{_NARROW.format('body.x')}"), "body.vx", partial(faster, lambda way: 1e4 * _narrow(way)), solver="projected", scheme="dop853",
    ),
    _case(
        "hollow as a power of a cosine", partial(flying, f"-1e4*{_COSINE.format('body.x')}"), "body.vx", partial(faster, lambda way: -1e4 * _cosine(way)), solver="bdf",
    ),
    _case(
        "bump as a power of a parabola", partial(flying, f"2e4*{_PARABOLA.format('body.x')}"), "body.vx", partial(faster, lambda way: 2e4 * _parabola(way)), solver="bdf",
    ),
    _case(
        "damper that acts in a narrow zone", partial(flying, f"-500*body.vx*{_PARABOLA.format('body.x')}"), "body.vx",
        partial(slower, lambda way: 500 * _parabola(way)), solver="bdf",
    ),
    _case(
        "torque over an angle", partial(turning, f"1e4*{_COSINE.format('wheel.angle')}"), "wheel.omega", partial(faster, lambda way: 1e4 * _cosine(way)), solver="bdf",
    ),
    _case(
        "bump in space", partial(in_space, f"1e4*{_NARROW.format('body.z')}"), "body.vz", partial(faster, lambda way: 1e4 * _narrow(way)), solver="projected", scheme="dop853",
    ),
    _case(
        "a bump that steps do see", partial(flying, f"1e4*{_NARROW.format('body.x')}"), "body.vx", partial(faster, lambda way: 1e4 * _narrow(way)), solver="bdf", max_step=1e-4,
    ),
)  # fmt: skip
