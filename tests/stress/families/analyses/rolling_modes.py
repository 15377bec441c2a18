"""Modes of moving systems on wheels or blades, which have fewer free velocities than poses."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.model.read_scene import read_scene

from ...case import Case, Outcome, Verdict, measured
from ...mechanisms.bicycle import bicycle, published

NEUTRAL = 1e-6
"""Largest eigenvalue that counts as zero, 1/s."""
ALLOWED = 1e-9

SKATE = """
parameters: {{a: {ahead} m}}
bodies: {{b: {{mass: 2, inertia: 0.5, velocity: [{speed}, 0], markers: {{blade: {{point: [-a, 0]}}}}}}}}
joints: {{grip: {{type: velocity_equation, zero: "vy(b.blade)*cos(az(b)) - vx(b.blade)*sin(az(b))"}}}}
forces: {{steer: {{type: torque, i: b, torque: "-{spring}*b.y - {damping}*b.omega - {centring}*b.angle"}}}}
"""
"""Body of 2 kg and 0.5 kg m^2 on a blade at a distance behind the centre of mass."""
TRAILER = """
bodies: {{b: {{mass: 2, inertia: 0.5, velocity: [{speed}, 0], markers: {{hitch: {{point: [0.3, 0]}}, axle: {{point: [-0.5, 0]}}}}}}}}
joints:
  rail: {{type: point_on_line, i: b.hitch, j: {{body: ground, point: [0.3, 0]}}}}
  pull: {{type: velocity_equation, zero: "vx(b.hitch) - {speed}"}}
  grip: {{type: velocity_equation, zero: "vy(b.axle)*cos(az(b)) - vx(b.axle)*sin(az(b))"}}
"""
WHEEL_WITH_PENDULUM = """
gravity: [0, -9.81]
bodies:
  wheel: {{mass: 3, inertia: 0.2, position: [0, 0.4], velocity: [{speed}, 0], omega: {spin!r}}}
  bob: {{mass: 1, inertia: 0.01, position: [0, 0.1], velocity: [{speed}, 0]}}
joints:
  floor: {{type: point_on_line, i: wheel, j: {{body: ground, point: [0, 0.4]}}}}
  rolls: {{type: velocity_equation, zero: "vx(wheel) + 0.4*wz(wheel)"}}
  hinge: {{type: revolute, i: {{body: bob, point: [0, 0.3]}}, j: wheel}}
"""
DISC = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  disc: {{mass: 2, inertia: [0.045, 0.09, 0.045], position: [0, 0, 0.3], velocity: [{speed!r}, 0, 0], omega: [0, {rate!r}, 0],
          markers: {{axis: {{point: [0, 1, 0]}}}}}}
joints:
  touch: {{type: equation, zero: "disc.z - 0.3*sqrt(1 - dz(disc.axis, disc)^2)"}}
  grip:
    type: velocity_equation
    zero:
      - "vx(disc) - 0.3*(wy(disc)*sqrt(1 - dz(disc.axis, disc)^2)
        + wz(disc)*dy(disc.axis, disc)*dz(disc.axis, disc)/sqrt(1 - dz(disc.axis, disc)^2))"
      - "vy(disc) + 0.3*(wx(disc)*sqrt(1 - dz(disc.axis, disc)^2)
        + wz(disc)*dx(disc.axis, disc)*dz(disc.axis, disc)/sqrt(1 - dz(disc.axis, disc)^2))"
"""


def _against(scene: Callable[[], Any], degrees_of_freedom: int, expected: Callable[[], np.ndarray]) -> Verdict:
    """Compare each nonzero eigenvalue with closed forms, and the number of modes with that of the eigenvalues."""
    found = modes(scene())
    values = [value for mode in found.modes for value in mode.eigenvalues if abs(value) > NEUTRAL]
    closed = [complex(value) for value in expected() if abs(value) > NEUTRAL]
    if found.degrees_of_freedom != degrees_of_freedom or len(values) != len(closed):
        return Verdict(Outcome.WRONG, detail=f"{found.degrees_of_freedom} degrees of freedom with {values}")
    if len(found.modes) < degrees_of_freedom:
        return Verdict(Outcome.WRONG, detail=f"{len(found.modes)} modes of {degrees_of_freedom}")
    error = 0.0
    for value in closed:
        nearest = min(values, key=lambda one: abs(one - value))
        values.remove(nearest)
        error = max(error, abs(nearest - value) / max(1.0, abs(value)))
    return measured(error, ALLOWED, f"{len(closed)} eigenvalues")


def _skate(speed: float, ahead: float = 0.0, spring: float = 0.0, damping: float = 0.0, centring: float = 0.0) -> Case:
    """Return the eigenvalues of (I + m a^2) p'' = -(m a V + d) p' - c p - k (y + a p), y' = V p; p and y of the blade."""
    inertia, carried = 0.5 + 2 * ahead**2, 2 * ahead * speed + damping
    roots = np.roots([inertia, carried, centring + spring * ahead, spring * speed])
    text = SKATE.format(speed=speed, ahead=ahead, spring=spring, damping=damping, centring=centring)
    name = f"skate at {speed:g} m/s, {ahead:g} m behind, steered by {spring:g}, {damping:g}, {centring:g}"
    return Case(name, "a cubic", partial(_against, partial(read_scene, text), 2, lambda: roots))


def _trailer(speed: float) -> Case:
    """Return the eigenvalue of p' = -V/L p, which has no free velocity."""
    scene = partial(read_scene, TRAILER.format(speed=speed))
    return Case(f"trailer at {speed:g} m/s", "-V/L", partial(_against, scene, 0, lambda: np.array([-speed / 0.8])))


def _wheel(speed: float) -> Case:
    """Return the eigenvalues of M x'' + m l p'' = 0, (J + m l^2) p'' + m l x'' = -m g l p; M includes wheel, spin and bob."""
    total, swing, coupling = 3 + 0.2 / 0.4**2 + 1, 0.01 + 0.3**2, 0.3
    square = 9.81 * 0.3 / (swing - coupling**2 / total)
    scene = partial(read_scene, WHEEL_WITH_PENDULUM.format(speed=speed, spin=-speed / 0.4))
    pair = np.sqrt(square) * np.array([1j, -1j])
    return Case(f"pendulum on a wheel at {speed:g} m/s", "w^2", partial(_against, scene, 2, lambda: pair))


def _disc(part: float) -> Case:
    """Return the eigenvalues of a thin disc: l^2 = (m g R A - C (C + m R^2) w^2)/(A (A + m R^2)); Neimark and Fufaev (1972), chapter III."""
    rate = part * float(np.sqrt(9.81 / 0.9))
    square = (2 * 9.81 * 0.3 * 0.045 - 0.09 * 0.27 * rate**2) / (0.045 * 0.225)
    root = np.sqrt(complex(square)) * np.array([1, -1])
    scene = partial(read_scene, DISC.format(speed=0.3 * rate, rate=rate))
    what = "against Neimark and Fufaev"
    return Case(
        f"disc that rolls upright at {part:g} of its critical speed", what, partial(_against, scene, 3, lambda: root)
    )


def _bicycle(speed: float) -> Case:
    judge = partial(_against, partial(bicycle, speed), 3, partial(published, speed))
    return Case(f"bicycle at {speed:g} m/s", "weave, capsize and castering against the published matrices", judge)


CASES = (
    _skate(1.0),
    _skate(1.0, damping=0.3),
    _skate(2.0, ahead=0.2),
    _skate(2.0, ahead=-0.2),
    _skate(1.0, spring=3.0, damping=2.0),
    _skate(1.5, ahead=0.1, spring=2.0, damping=4.0, centring=1.0),
    _skate(3.0, centring=2.0),
    *map(_trailer, (0.5, 5.0)),
    *map(_wheel, (0.0, 4.0)),
    *map(_disc, (0.5, 0.9, 1.1, 3.0)),
    *map(_bicycle, range(11)),
)
