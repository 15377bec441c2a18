"""Stiffness and damping of a bushing from noisy accelerations of the arm that it holds."""

from __future__ import annotations

from stiffmbs.reading.variation import Range

from ..intervals import IntervalRuns

SCENE = """
name: Arm in a bushing
parameters: {k: 3e5 N/m, c: 200 N s/m}
gravity: [0, -9.81]
bodies:
  arm: {mass: 8 kg, inertia: 0.2 kg m^2, position: [0.3, 0], markers: {eye: {point: [-0.3, 0]}, seat: {point: [0.2, 0]}}}
forces:
  bushing: {type: bushing, i: arm.eye, j: ground, axes: ground, stiffness: [k, k, 50], damping: [c, c, 0.5]}
  spring: {type: spring_damper, i: arm.seat, j: {body: ground, point: [0.5, 0.4]}, stiffness: 2e4, damping: 300, free_length: 0.41}
run: {duration: 0.5 s, output: 5 ms, rtol: 1e-7}
"""
BENCHMARKS = (
    IntervalRuns(
        "bushing_fit",
        SCENE,
        {"k": Range(1e5, 1e6, log=True), "c": Range(20, 2e3, log=True)},
        {"arm.ax": 0.05, "arm.ay": 0.1},
    ),
)
