"""A thousand seconds of pendulums: closed form, violation of the joints, drift of the energy, memory."""

from __future__ import annotations

import gc
import os
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.model.read_scene import read_scene
from stiffmbs.results.solution import Solution

from ...case import Case, Verdict, measured
from ...mechanisms.pendulum import GRAVITY, bar_rate, swing
from ...simulation import simulation

LONG = 1000.0
CART_PENDULUM = """
gravity: [0, -9.81]
bodies:
  cart: {mass: 10, inertia: 1}
  bar: {mass: 1, inertia: 0.03, position: [0.3*sin(20 deg), -0.3*cos(20 deg)], angle: -70 deg}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: cart, j: {body: bar, point: [-0.3, 0]}}
forces:
  spring: {type: spring_damper, i: cart, j: {body: ground, point: [-1, 0]}, stiffness: 270, free_length: 1}
"""


def bar_pendulum() -> Model:
    """A bar of 1 m hung by its end, let go from the horizontal."""
    model = Model("Pendulum", gravity=(0, -GRAVITY))
    bar = model.add("bar", Body(mass=1, inertia=1 / 12, position=(0.5, 0)))
    model.add("hinge", JOINTS["revolute"](i=bar.at(-0.5, 0), j="ground"))
    return model


def _angle(solution: Solution) -> float:
    expected = swing(solution.t, np.pi / 2, bar_rate(1.0))
    return float(np.max(np.abs(solution["bar.angle"] + np.pi / 2 - expected)))


def _violation(solution: Solution) -> float:
    return float(max(np.max(solution["constraint.position"]), np.max(solution["constraint.velocity"])))


def _energy(solution: Solution) -> float:
    return solution.energy_drift()


def _growth(duration: float) -> Verdict:
    """Growth of the process over a run that is as long again as one before it, with as few rows."""
    scene = read_scene(CART_PENDULUM)
    for _ in range(2):
        run(scene, duration=duration / 10, points=11)
    before = _resident()
    run(scene, duration=duration, points=11)
    grown = _resident() - before
    return measured(grown / 1e6, 60.0, "MB; the history keeps 24 bytes a step, up to a million steps")


def _resident() -> float:
    """Bytes of the process in memory."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * float(os.sysconf("SC_PAGE_SIZE"))


def _both(duration: float, rtol: float, drift: float, quick: bool) -> tuple[Case, ...]:
    time = f"{duration:g} s, rtol {rtol:.0e}"
    how: dict[str, Any] = {"duration": duration, "rtol": rtol, "points": 1001, "quick": quick}
    read = partial(read_scene, CART_PENDULUM)
    return (
        simulation(f"pendulum, {time}: violation", "joints in m and m/s", bar_pendulum, _violation, 1e-10, **how),
        simulation(
            f"pendulum, {time}: energy", "change in J; it swings with 4.9 J", bar_pendulum, _energy, drift, **how
        ),
        simulation(f"cart-pendulum, {time}: violation", "joints in m and m/s", read, _violation, 1e-10, **how),
        simulation(f"cart-pendulum, {time}: energy", "change in J; it swings with 0.18 J", read, _energy, drift, **how),
    )


CASES = (
    *_both(100.0, 1e-8, 1e-3, quick=True),
    *_both(LONG, 1e-10, 1e-4, quick=False),
    simulation(
        "pendulum, 100 s: angle", "against elliptic functions", bar_pendulum, _angle, 1e-3,
        duration=100.0, points=1001, rtol=1e-10,
    ),
    simulation(
        "pendulum, 1000 s: angle", "against elliptic functions", bar_pendulum, _angle, 1e-2,
        duration=LONG, points=1001, rtol=1e-11, quick=False,
    ),
    simulation(
        "pendulum, 1000 s, projected dop853: angle", "against elliptic functions", bar_pendulum, _angle, 1e-4,
        duration=LONG, points=1001, rtol=1e-12, solver="projected", scheme="dop853", quick=False,
    ),
    Case("memory over 1000 s", "growth of the process in MB, cart-pendulum", partial(_growth, LONG), quick=False),
)  # fmt: skip
