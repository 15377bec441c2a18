"""Vehicles that drive along x: a quarter car and a half car on vertical tyres, and the car of the examples."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from stiffmbs import __file__ as package
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene

CAR = Path(package).parent.parent / "examples" / "car.yaml"
Points = list[list[float]]


def lines(points: Points) -> str:
    """Return a piecewise linear road, as in a scene."""
    return f"{{type: table, profile: {{table: {points}, lines: true}}}}"


def left_lines(points: Points) -> str:
    """Return a road that is level on the right."""
    level = [[points[0][0], 0.0], [points[-1][0], 0.0]]
    return (
        f"{{type: table, track: 1.52, left: {{table: {points}, lines: true}}, right: {{table: {level}, lines: true}}}}"
    )


def quarter_car(road: str, speed: float) -> Scene:
    """Return a quarter car: a sprung body above a wheel, both upright and free along the road."""
    return read_scene(
        f"""
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {{V: {speed}}}
roads: {{r: {road}}}
bodies:
  slide: {{mass: 1, inertia: [1, 1, 1], velocity: [V, 0, 0]}}
  body: {{mass: 320, inertia: [50, 50, 50], position: [0, 0, 0.7], velocity: [V, 0, 0]}}
  wheel: {{mass: 38, inertia: [1, 1, 1], position: [0, 0, 0.29], velocity: [V, 0, 0]}}
joints:
  along: {{type: prismatic, i: {{body: slide, orientation: {{z: [1, 0, 0]}}}}, j: {{body: ground, orientation: {{z: [1, 0, 0]}}}}}}
  body_up: {{type: prismatic, i: body, j: slide}}
  wheel_up: {{type: prismatic, i: wheel, j: slide}}
forces:
  suspension: {{type: spring_damper, i: body, j: wheel, stiffness: 20e3, damping: 1500, free_length: 0.567}}
  tyre: {{type: vertical_tyre, i: wheel, radius: 0.31, stiffness: 190e3, damping: 100, road: r}}
"""
    )


def half_car(road: str, speed: float) -> Scene:
    """Return a chassis that heaves and pitches on two sprung wheels."""
    return read_scene(
        f"""
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {{V: {speed}}}
roads: {{r: {road}}}
bodies:
  chassis: {{mass: 640, inertia: [300, 900, 900], position: [0, 0, 0.7], velocity: [V, 0, 0]}}
  front: {{mass: 38, inertia: [1, 1, 1], position: [1.25, 0, 0.29], velocity: [V, 0, 0]}}
  rear: {{mass: 38, inertia: [1, 1, 1], position: [-1.25, 0, 0.29], velocity: [V, 0, 0]}}
joints:
  plane: {{type: planar, i: {{body: chassis, orientation: {{z: [0, 1, 0]}}}}, j: {{body: ground, orientation: {{z: [0, 1, 0]}}}}}}
  front_up: {{type: prismatic, i: front, j: {{body: chassis, point: [1.25, 0, 0]}}}}
  rear_up: {{type: prismatic, i: rear, j: {{body: chassis, point: [-1.25, 0, 0]}}}}
forces:
  front_spring: {{type: spring_damper, i: {{body: chassis, point: [1.25, 0, 0]}}, j: front, stiffness: 20e3, damping: 1500, free_length: 0.567}}
  rear_spring: {{type: spring_damper, i: {{body: chassis, point: [-1.25, 0, 0]}}, j: rear, stiffness: 20e3, damping: 1500, free_length: 0.567}}
  front_tyre: {{type: vertical_tyre, i: front, radius: 0.31, stiffness: 190e3, damping: 100, road: r}}
  rear_tyre: {{type: vertical_tyre, i: rear, radius: 0.31, stiffness: 190e3, damping: 500, road: r}}
"""
    )


def car(compliance: str) -> Callable[[str, float], Scene]:
    """Return a function that creates the car of the examples with `bushing` or `rigid` joints."""

    def of_road(road: str, speed: float) -> Scene:
        changes = (
            ("roads.course", road), ("parameters.V", f"{speed!r} m/s"), ("choose.compliance", compliance),
        )  # fmt: skip
        return load_scene(CAR, changes)

    return of_road
