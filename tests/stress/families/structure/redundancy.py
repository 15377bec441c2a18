"""Scenes with too many equations, too few, or contradicting ones."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...mechanisms.parallelogram import parallelogram, swing_error
from ...mechanisms.pendulum import GRAVITY
from ...simulation import refusal, simulation
from ..scales.long_runs import bar_pendulum


def _on_ground(x: float, y: float) -> Marker:
    return Marker(body="ground", point=(x, y))


def pendulum_with_drives(*laws: str) -> Model:
    """A pendulum whose one coordinate several motors drive."""
    model = bar_pendulum()
    for k, law in enumerate(laws):
        model.add(f"motor{k + 1}", JOINTS["drive"](joint="hinge", position=law))
    return model


def _driven(solution: Solution) -> float:
    return float(np.max(np.abs(solution["bar.angle"] - 0.3 * solution.t)))


def rod_too_short() -> Model:
    """A pendulum whose end a rod of 1 m is to hold at a point that is 5 m away."""
    model = bar_pendulum()
    model.add("strut", JOINTS["distance"](i=Marker(body="bar", point=(0.5, 0)), j=_on_ground(5, 0), length=1.0))
    return model


def truss() -> Model:
    """Two bars of 1 m pinned to the ground and to each other, at 45 degrees: nothing moves, and it carries its weight."""
    model = Model("Truss", gravity=(0, -GRAVITY))
    half = np.sqrt(0.5) / 2
    left = model.add("left", Body(mass=1, inertia=1 / 12, position=(half, half), angle=np.pi / 4))
    right = model.add("right", Body(mass=1, inertia=1 / 12, position=(3 * half, half), angle=3 * np.pi / 4))
    model.add("left_pin", JOINTS["revolute"](i=left.at(-0.5, 0), j="ground"))
    model.add("right_pin", JOINTS["revolute"](i=right.at(-0.5, 0), j=_on_ground(4 * half, 0)))
    model.add("top", JOINTS["revolute"](i=left.at(0.5, 0), j=right.at(0.5, 0)))
    return model


def _statics(solution: Solution) -> float:
    """Each foot carries a weight upwards and half a weight inwards."""
    loads = {
        "left_pin.fx": 0.5,
        "left_pin.fy": 1.0,
        "right_pin.fx": -0.5,
        "right_pin.fy": 1.0,
        "top.fx": -0.5,
        "top.fy": 0.0,
    }
    return float(max(np.max(np.abs(solution[name] / GRAVITY - load)) for name, load in loads.items()))


def doubled_hinge() -> Model:
    """A pendulum with a second hinge at the place of the first."""
    model = bar_pendulum()
    model.add("again", JOINTS["revolute"](i=Marker(body="bar", point=(-0.5, 0)), j="ground"))
    return model


def _weight_of_both(solution: Solution) -> float:
    """The two hinges together carry what one would: 5/2 m g cos along the bar and 1/4 m g sin across it."""
    phi = solution["bar.angle"] + np.pi / 2
    expected = 2.5 * np.cos(phi) ** 2 + 0.25 * np.sin(phi) ** 2
    return float(np.max(np.abs((solution["hinge.fy"] + solution["again.fy"]) / GRAVITY - expected)))


def adrift() -> Model:
    """Two hinged bodies that nothing holds, thrown without turning: their common centre flies a parabola."""
    model = Model("Adrift", gravity=(0, -GRAVITY))
    one = model.add("one", Body(mass=1, inertia=0.1, position=(0, 0), velocity=(1, 2), omega=3))
    two = model.add("two", Body(mass=3, inertia=0.2, position=(1, 0), velocity=(1, 2)))
    model.add("hinge", JOINTS["revolute"](i=one.at(0.5, 0), j=two.at(-0.5, 0)))
    return model


def _parabola(solution: Solution) -> float:
    x = (solution["one.x"] + 3 * solution["two.x"]) / 4
    y = (solution["one.y"] + 3 * solution["two.y"]) / 4
    vx = (solution["one.vx"][0] + 3 * solution["two.vx"][0]) / 4
    vy = (solution["one.vy"][0] + 3 * solution["two.vy"][0]) / 4
    t = solution.t
    return float(max(np.max(np.abs(x - 0.75 - vx * t)), np.max(np.abs(y - vy * t + GRAVITY / 2 * t**2))))


def motor_beyond_reach() -> Model:
    """A motor turns a crank of 1 m whose rod of 0.5 m ends on the x axis: at 30 degrees the rod stands upright."""
    model = Model("Locked")
    crank = model.add("crank", Body(mass=1, inertia=1 / 12, position=(0.5, 0)))
    model.add("slider", Body(mass=1, inertia=1, position=(1.5, 0)))
    model.add("pin", JOINTS["revolute"](i=crank.at(-0.5, 0), j="ground"))
    model.add("guide", JOINTS["prismatic"](i="slider", j="ground"))
    model.add("rod", JOINTS["distance"](i=crank.at(0.5, 0), j="slider", length=0.5))
    model.add("motor", JOINTS["drive"](joint="pin", position="t"))
    return model


def _slider(solution: Solution) -> float:
    """Of x = cos(t) + sqrt(1/4 - sin(t)^2), whose slope is without bound at t = pi/6."""
    before = solution.t < np.pi / 6 - 1e-3
    expected = np.cos(solution.t) + np.sqrt(np.maximum(0.25 - np.sin(solution.t) ** 2, 0))
    beyond = np.any(solution.t > np.pi / 6 + 1e-6)
    return float("inf") if beyond else float(np.max(np.abs(solution["slider.x"] - expected)[before]))


def seized() -> Model:
    """A bar with both ends pinned to the ground by joints that do not meet."""
    model = bar_pendulum()
    model.add("far", JOINTS["revolute"](i=Marker(body="bar", point=(0.5, 0)), j=_on_ground(1.001, 0)))
    return model


def spring_on_nothing() -> Model:
    """A spring between two markers at one point, with a free length: its direction is not defined."""
    model = Model("Spring without a direction")
    model.add("mass", Body(mass=1, inertia=1))
    model.add("spring", FORCES["spring_damper"](i="mass", j="ground", stiffness=10.0, free_length=1.0))
    return model


CASES = (
    simulation(
        "redundant crank", "parallelogram with three cranks; angle against elliptic functions",
        partial(parallelogram, cranks=3), swing_error, 1e-5, noted=("crank2", "left out"), expected=Outcome.TOLD,
        duration=1.0, points=101, rtol=1e-8,
    ),
    simulation(
        "doubled hinge", "sum of both hinges' forces, in weights, against one hinge",
        doubled_hinge, _weight_of_both, 1e-6, noted=("again",), expected=Outcome.TOLD,
        duration=1.0, points=101, rtol=1e-8,
    ),
    refusal("inconsistent: rod too short", "a gap that no pose closes", rod_too_short, ("strut",)),
    refusal("inconsistent: two pins 1 mm apart", "a bar of 1 m between points 1.001 m apart", seized, ("far",)),
    refusal(
        "over-driven: two motors that disagree", "0.3 t and 0.4 t on one hinge",
        partial(pendulum_with_drives, "0.3*t", "0.4*t"), ("motor1", "motor2"),
    ),
    refusal(
        "over-driven: two motors that disagree late", "0.3 t, and from t = 7 s on something else",
        partial(pendulum_with_drives, "0.3*t", "0.3*t + step(t, 7, 0, 8, 1)"), ("motor1", "motor2"),
    ),
    simulation(
        "over-driven: two motors that agree", "0.3 t and 0.3 t on one hinge",
        partial(pendulum_with_drives, "0.3*t", "0.3*t"), _driven, 1e-9, noted=("motor2",), expected=Outcome.TOLD,
        duration=1.0, points=11,
    ),
    simulation("under-constrained: bodies adrift", "their centre against the parabola", adrift, _parabola, 1e-5,
               duration=1.0, points=101, rtol=1e-8),
    simulation("nothing moves: truss", "reactions in weights against statics", truss, _statics, 1e-9, duration=1.0, points=11),
    *(
        simulation(
            f"locked: a motor beyond a rod's reach, {solver}", "slider against its closed form up to 30 degrees",
            motor_beyond_reach, _slider, 1e-4, expected=Outcome.TOLD,
            duration=3.0, points=3001, rtol=1e-8, solver=solver,
        )
        for solver in ("bdf", "projected", "kinematic")
    ),
    refusal("no direction", "a spring between points that coincide", spring_on_nothing, ("spring", "apart")),
)  # fmt: skip
