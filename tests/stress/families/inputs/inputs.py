"""Inputs over time with jumps, pulses and poles, against closed forms."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...simulation import simulation


def sled(force: str) -> Model:
    """1 kg at rest on a rail under a force over time."""
    model = Model("Sled")
    model.add("sled", Body(mass=1, inertia=1))
    model.add("rail", JOINTS["prismatic"](i="sled", j="ground"))
    model.add("push", FORCES["force"](i="sled", force=(force, 0)))
    return model


def driven(**law: Any) -> Model:
    """1 kg on a rail that a drive moves."""
    model = Model("Driven sled")
    model.add("sled", Body(mass=1, inertia=1))
    model.add("rail", JOINTS["prismatic"](i="sled", j="ground"))
    model.add("motor", JOINTS["drive"](joint="rail", **law))
    return model


def _speed(solution: Solution, expected: float) -> float:
    """Of the speed at the end, relative to the impulse."""
    return float(abs(solution["sled.vx"][-1] / expected - 1))


def _pushed(name: str, force: str, impulse: float, allowed: float = 1e-3, **how: Any):
    return simulation(
        name, f"force {force}; speed at the end against the impulse", partial(sled, force),
        partial(_speed, expected=impulse), allowed, **{"duration": 10.0, "points": 11, "rtol": 1e-6, **how},
    )  # fmt: skip


_ARCH = float(2 * (np.sqrt(1 - 0.81) - 0.9 * np.arccos(0.9)) / (2 * np.pi))
"""Mean of max(0, sin - 0.9)."""


def _pulses(width: float):
    """Ten pulses, one a second, each as long as `width`, s: tops of a sine; 1 N s in all."""
    w = np.pi * width
    half = np.sqrt(2) * np.sin(w / 2)
    arch = (np.sin(w) - w * np.cos(w) if w > 1e-2 else w**3 / 3) / np.pi
    force = f"{0.1 / arch:.17g}*max(0, {half**2:.17g} - 2*sin(pi*t - 1)^2)"
    return _pushed(f"pulses max(0, ...) of {width:.0e} s, one a second", force, 1.0, 1e-2)


def _way(solution: Solution, law: Any) -> float:
    return float(np.max(np.abs(solution["sled.x"] - law(solution.t))))


def _before_the_pole(solution: Solution) -> float:
    """x'' = 1/(1 - t)^2 from rest: x = -t - log(1 - t), without bound at t = 1; relative error a little before."""
    t, x = solution.t, solution["sled.x"]
    if t[-1] > 1:
        return float("inf")
    before = t < 0.99
    expected = -t[before] - np.log1p(-t[before])
    return float(np.max(np.abs(x[before] - expected) / (1 + expected)))


JUMP = {"table": [[0, 0], [1, 0], [1.000000001, 0.1], [2, 0.1]], "lines": True}
KINK = {"table": [[0, 0], [1, 1], [2, 0]], "lines": True}
SPEEDS = {"table": [[0, 0], [1, 0], [1.000000001, 2], [2, 2]], "lines": True}

CASES = (
    _pushed("pulse of 1 ms after a rest of 9 s", "1000*(step(t, 9, 0, 9.0001, 1) - step(t, 9.001, 0, 9.0011, 1))", 1.0),
    _pushed("pulse of 1 us", "1e6*(step(t, 5, 0, 5.0000001, 1) - step(t, 5.000001, 0, 5.0000011, 1))", 1.0),
    *(_pulses(width) for width in (1e-3, 1e-5, 1e-6)),
    _pushed("pulses max(0, sin) of 2 Hz in a run of 1000 s", "max(0, sin(4*pi*t) - 0.9)", 1000 * _ARCH, duration=1000.0, quick=False),
    _pushed("square wave of 1 kHz", "sign(sin(2000*pi*t)) + 1", 1.0, duration=1.0),
    _pushed("two steps at one instant", "step(t, 5, 0, 5.001, 1) - step(t, 5, 0, 5.001, 1) + 0.1", 1.0),
    simulation(
        "drive that jumps by 0.1 m in 1 ns", "told, as its force has no bound; way against the table", partial(driven, position=JUMP),
        partial(_way, law=lambda t: np.where(t > 1, 0.1, 0.0)), 1e-6, noted=("jump", "t = 1"), expected=Outcome.TOLD,
        duration=2.0, points=21,
    ),
    simulation(
        "drive whose speed turns round", "told; way against the table", partial(driven, position=KINK),
        partial(_way, law=lambda t: 1 - np.abs(t - 1)), 1e-6, noted=("jump", "t = 1"), expected=Outcome.TOLD, duration=2.0, points=21,
    ),
    simulation(
        "driven speed that jumps to 2 m/s in 1 ns", "told; way against the table", partial(driven, velocity=SPEEDS),
        partial(_way, law=lambda t: np.maximum(0, 2 * (t - 1))), 1e-6, noted=("jump", "t = 1"), expected=Outcome.TOLD, duration=2.0, points=21,
    ),
    simulation(
        "force with a pole", "1/(1 - t)^2; way before the pole", partial(sled, "(1 - t)^-2"), _before_the_pole, 1e-4,
        expected=Outcome.TOLD, duration=2.0, points=21, rtol=1e-6,
    ),
    simulation(
        "drive with a pole", "position 1/(1 - t) - 1; way before the pole", partial(driven, position="1/(1 - t) - 1"),
        lambda solution: float("inf") if solution.t[-1] > 1 else _way(solution, lambda t: 1 / (1 - t) - 1), 1e-3,
        expected=Outcome.TOLD, duration=2.0, points=21, rtol=1e-6,
    ),
    simulation(
        "force without a value from 1 s on", "sqrt(1 - t)", partial(sled, "sqrt(1 - t)"),
        lambda solution: float(np.max(np.abs(solution["sled.vx"] - 2 / 3 * (1 - np.maximum(1 - solution.t, 0) ** 1.5)))), 1e-4,
        expected=Outcome.TOLD, duration=2.0, points=201, rtol=1e-6,
    ),
)  # fmt: skip
