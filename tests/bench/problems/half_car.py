"""The half car of ``examples/half_car.yaml`` over its bump, 5 s with 1001 output points, by the stiffness of its bushings."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.model.read_scene import read_scene

from ..by_hand import half_car as hand
from ..by_hand.runge_kutta import half_car_rows
from ..contestant import Contestant, auto, bdf, bdf_of_all, by_hand, dop853
from ..problem import Problem
from ..task import Minimal, Task

SCENE = """
name: Half car
parameters:
  k_b: STIFFNESS
  zeta: 0.02
  c_b: zeta*sqrt(2*k_b*40)
  V: 15
gravity: [0, -9.81]
bodies:
  chassis:
    mass: 1200 kg
    inertia: 1800 kg m^2
    position: [0, 0.60]
    markers:
      front_pivot: {point: [1.80, -0.25]}
      rear_pivot: {point: [-0.90, -0.25]}
      front_seat: {point: [1.50, 0.20]}
      rear_seat: {point: [-1.20, 0.20]}
  front:
    mass: 40 kg
    inertia: 1.5 kg m^2
    position: [1.45, 0.31]
    markers:
      pivot: {point: [0.35, 0.04]}
      seat: {point: [0.05, 0.04]}
      wheel: {point: [-0.10, -0.01]}
  rear:
    mass: 40 kg
    inertia: 1.5 kg m^2
    position: [-1.25, 0.31]
    markers:
      pivot: {point: [0.35, 0.04]}
      seat: {point: [0.05, 0.04]}
      wheel: {point: [-0.10, -0.01]}
forces:
  front_bushing:
    type: bushing
    i: front.pivot
    j: chassis.front_pivot
    axes: ground
    stiffness: [2*k_b, 2*k_b, 2*500 N m/rad]
    damping: [2*c_b, 2*c_b, 2*5 N m s/rad]
    preload: [0, 3088.333333, 0]
  rear_bushing:
    type: bushing
    i: rear.pivot
    j: chassis.rear_pivot
    axes: ground
    stiffness: [2*k_b, 2*k_b, 2*500 N m/rad]
    damping: [2*c_b, 2*c_b, 2*5 N m s/rad]
    preload: [0, 3059.266667, 0]
  front_spring:
    type: spring_damper
    i: front.seat
    j: chassis.front_seat
    stiffness: 60e3
    damping: 5e3
    free_length: 0.45
    preload: -9003.4
  rear_spring:
    type: spring_damper
    i: rear.seat
    j: chassis.rear_seat
    stiffness: 60e3
    damping: 5e3
    free_length: 0.45
    preload: -8916.2

  front_tyre:
    type: force
    i: front.wheel
    force:
      - 0
      - >-
        6307.466667 + 200e3*(0.05*(1 - cos(pi*min(max(V*t, 0), 2))) - (dy(front.wheel) - 0.30))
        + 500*(0.05*pi*V*sin(pi*min(max(V*t, 0), 2)) - vy(front.wheel))
  rear_tyre:
    type: force
    i: rear.wheel
    force:
      - 0
      - >-
        6249.333333 + 200e3*(0.05*(1 - cos(pi*min(max(V*t - 2.7, 0), 2))) - (dy(rear.wheel) - 0.30))
        + 500*(0.05*pi*V*sin(pi*min(max(V*t - 2.7, 0), 2)) - vy(rear.wheel))
run: {duration: 5 s, output: 5 ms}
"""
ZETA = 0.02
PARTS = 600
"""Steps of the reference between two output times; breakpoints of the road are met by multiples of 3."""
TIMES = np.arange(1001) * 5e-3
CONVERGED = {1e5: (0.630036205, 0.6000148835), 1e7: (0.630518269, 0.6000148713), 1e9: (0.630521686, 0.6000148639)}
"""The chassis' largest height at output points, and that at the end, from other programs at rtol 1e-12; SciPy's DOP853
on the minimal equations gives the same digits."""


def contestants(k_b: float) -> list[Contestant]:
    """This package beside IDA by hand; explicit methods where they come to an end soon."""
    scene = read_scene(SCENE.replace("STIFFNESS", f"{k_b:g}"))
    explicit = [dop853(scene)] if k_b < 1e8 else []
    return [bdf(scene), bdf_of_all(scene), by_hand(hand.si2(k_b, ZETA), TIMES), *explicit, auto(scene)]


def reference(k_b: float) -> np.ndarray:
    """Short steps of the classical Runge-Kutta method: from twice as long ones it differs by 5e-12 m at 1e10 N/m."""
    k, c = hand.numbers_of(k_b, ZETA)
    return half_car_rows(hand.minimal_start(), TIMES, PARTS, k, c)[:, : hand.V]


def task(k_b: float) -> Task:
    """The problem for other tools; it has no joints, so its coordinates are minimal."""
    k, c = hand.numbers_of(k_b, ZETA)
    rates, jacobian = partial(hand.minimal, k=k, c=c), partial(hand.minimal_jacobian, k=k, c=c)
    minimal = Minimal(rates, hand.minimal_start(), lambda y: y[:, : hand.V], jacobian)
    return Task(read_scene(SCENE.replace("STIFFNESS", f"{k_b:g}")), TIMES, minimal, hand.CORNERS)


def _problem(name: str) -> Problem:
    k_b = float(name)
    return Problem(f"half_car_{name}", partial(reference, k_b), partial(contestants, k_b), task=partial(task, k_b))


BENCHMARKS = tuple(_problem(name) for name in ("1e5", "1e6", "1e7", "1e8", "1e9"))
