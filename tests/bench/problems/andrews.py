"""Andrews' squeezing mechanism, 0.03 s with 301 output points."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.model.read_scene import read_scene

from ..by_hand import andrews as hand
from ..by_hand import andrews_minimal
from ..contestant import Contestant, auto, bdf, bdf_of_all, by_hand, converged, dop853, minimal
from ..problem import Problem
from ..task import Minimal, Task

SCENE = """
name: Andrews' squeezing mechanism
parameters:
  beta: -0.0617138900142764496
  Theta: 0
  gamma: 0.455279819163070380
  Phi: 0.222668390165885885
  delta: 0.487364979543842550
  Omega: -0.222668390165885885
  epsilon: 1.23054744454982119
  d: 28 mm
  da: 11.5 mm
  e: 20 mm
  ea: 14.21 mm
  rr: 7 mm
  ra: 0.92 mm
  ss: 35 mm
  sa: 18.74 mm
  sb: 10.43 mm
  sc: 18 mm
  sd: 20 mm
  ta: 23.08 mm
  tb: 9.16 mm
  u: 40 mm
  ua: 12.28 mm
  ub: 4.49 mm
  zf: 20 mm
  zt: 40 mm
  fa: 14.21 mm
  Ax: -69.34 mm
  Ay: -2.27 mm
  Bx: -36.35 mm
  By: 32.73 mm

bodies:
  K1:
    mass: 0.04325
    inertia: 2.194e-6
    position: [ra*cos(beta), ra*sin(beta)]
    angle: beta
    markers: {O: {point: [-ra, 0]}, F: {point: [rr - ra, 0]}}
  K2:
    mass: 0.00365
    inertia: 4.410e-7
    position: [rr*cos(beta) - da*cos(beta + Theta), rr*sin(beta) - da*sin(beta + Theta)]
    angle: beta + Theta
    markers: {F: {point: [da, 0]}, P: {point: [da - d, 0]}}
  K3:
    mass: 0.02373
    inertia: 5.255e-6
    position: [Bx + sa*sin(gamma) + sb*cos(gamma), By - sa*cos(gamma) + sb*sin(gamma)]
    angle: gamma
    markers: {B: {point: [-sb, sa]}, P: {point: [-sb, sa - ss]}, D: {point: [sd - sb, sa - sc]}}
  K4:
    mass: 0.00706
    inertia: 5.667e-7
    position:
      - Ax + zt*cos(delta) + (e - ea)*sin(Phi + delta)
      - Ay + zt*sin(delta) - (e - ea)*cos(Phi + delta)
    angle: Phi + delta
    markers: {E: {point: [0, e - ea]}, P: {point: [0, -ea]}}
  K5:
    mass: 0.07050
    inertia: 1.169e-5
    position: [Ax + ta*cos(delta) - tb*sin(delta), Ay + ta*sin(delta) + tb*cos(delta)]
    angle: delta
    markers: {A: {point: [-ta, -tb]}, E: {point: [zt - ta, -tb]}}
  K6:
    mass: 0.00706
    inertia: 5.667e-7
    position:
      - Ax + u*sin(epsilon) + (zf - fa)*cos(Omega + epsilon)
      - Ay - u*cos(epsilon) + (zf - fa)*sin(Omega + epsilon)
    angle: Omega + epsilon
    markers: {H: {point: [fa - zf, 0]}, P: {point: [fa, 0]}}
  K7:
    mass: 0.05498
    inertia: 1.912e-5
    position: [Ax + ua*sin(epsilon) - ub*cos(epsilon), Ay - ua*cos(epsilon) - ub*sin(epsilon)]
    angle: epsilon
    markers: {A: {point: [ub, ua]}, H: {point: [ub, ua - u]}}

joints:
  O: {type: revolute, i: K1.O, j: ground}
  F: {type: revolute, i: K2.F, j: K1.F}
  B: {type: revolute, i: K3.B, j: {body: ground, point: [Bx, By]}}
  A5: {type: revolute, i: K5.A, j: {body: ground, point: [Ax, Ay]}}
  A7: {type: revolute, i: K7.A, j: {body: ground, point: [Ax, Ay]}}
  E: {type: revolute, i: K4.E, j: K5.E}
  H: {type: revolute, i: K6.H, j: K7.H}
  P3: {type: revolute, i: K3.P, j: K2.P}
  P4: {type: revolute, i: K4.P, j: K2.P}
  P6: {type: revolute, i: K6.P, j: K2.P}

forces:
  motor: {type: torque, i: K1, torque: 0.033}
  spring:
    type: spring_damper
    i: K3.D
    j: {body: ground, point: [14 mm, 72 mm]}
    stiffness: 4530 N/m
    free_length: 77.85 mm


run: {duration: 0.03 s, points: 301}
"""
TIMES = np.linspace(0.0, 0.03, 301)
ANGLES_AT_END = (
    15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
    0.5244099658805304, 0.5347301163226948, 1.048080741042263,
)  # fmt: skip
"""(beta Theta gamma Phi delta Omega epsilon) as published, right to 3e-10 of their size; the reference is the index-1
form in these angles with SciPy's DOP853 at rtol 1e-13."""


def contestants() -> list[Contestant]:
    """This package beside SI2 by hand in the same coordinates, and index 1 in the seven angles."""
    scene = read_scene(SCENE)
    return [
        bdf(scene), bdf_of_all(scene), by_hand(hand.si2(), TIMES), dop853(scene),
        minimal(andrews_minimal.minimal, andrews_minimal.start(), andrews_minimal.places, TIMES), auto(scene),
    ]  # fmt: skip


def task() -> Task:
    """The problem for other tools."""
    minimal = Minimal(andrews_minimal.minimal, andrews_minimal.start(), andrews_minimal.places)
    return Task(read_scene(SCENE), TIMES, minimal)


BENCHMARKS = (
    Problem(
        "andrews",
        partial(converged, andrews_minimal.minimal, andrews_minimal.start(), andrews_minimal.places, TIMES),
        contestants,
        task=task,
    ),
)
