"""CONTACT of two solids with damping and friction against equations that share no code, each pair by a distance of its own."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import brentq

from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import moves_alike, played
from .test_adams_trial_forces import step

pytestmark = [pytest.mark.long, pytest.mark.sampled(2)]

TIMES = np.linspace(0, 0.2, 11)
LAW = (3e4, 40.0, 1.3, 2e-3)
RUB = (0.3, 0.2, 0.05, 0.3)
CONTACT = """
CONTACT/1, IGEOM=1, JGEOM=2
, IMPACT, STIFFNESS=3E4, DAMPING=40, EXPONENT=1.3, DMAX=2E-3
, COULOMB_FRICTION=ON, MU_STATIC=0.3, MU_DYNAMIC=0.2
, STICTION_TRANSITION_VELOCITY=0.05, FRICTION_TRANSITION_VELOCITY=0.3
"""
I, J = Marker(0), Marker(1)


def impact(nearest):
    """The force of the law above, where `nearest` gives gap, point and normal towards the first part, in ground axes."""
    stiffness, damping, exponent, depth = LAW
    static, dynamic, slow, fast = RUB

    def force(view):
        gap, at, n = nearest(view.r, view.turns)
        if gap >= 0:
            return
        v = view.v[0] + np.cross(view.w[0], at - view.r[0]) - view.v[1] - np.cross(view.w[1], at - view.r[1])
        rate = v @ n
        pressure = max(stiffness * (-gap) ** exponent - damping * rate * step(gap, -depth, 1, 0, 0), 0)
        slide = v - rate * n
        speed = np.sqrt(slide @ slide + (1e-6 * slow) ** 2)
        mu = step(speed, -slow, -static, slow, static) + step(speed, slow, 0, fast, dynamic - static)
        push = pressure * (n - mu * slide / speed)
        view.push(I, at, push)
        view.push(J, at, -push)

    return force


def compare(folder, graphics, parts, nearest, tolerance, rtol=1e-9):
    text = ""
    for k, part in enumerate(parts):
        d = np.diag(part.inertia)
        angles = ", ".join(f"{a}D" for a in part.angles)
        (x, y, z), (u, v, w), (p, q, r) = part.center, part.velocity, part.spin
        text += (
            f"PART/{k + 2}, MASS={part.mass}, CM={k + 2}1, IP={d[0]},{d[1]},{d[2]}, QG={x},{y},{z}, REULER={angles}\n"
            f", VX={u}, VY={v}, VZ={w}, WX={p}, WY={q}, WZ={r}, VM=1, WM=1\n"
            f"MARKER/{k + 2}1, PART={k + 2}\n"
        )
    solution = played(folder, text + "MARKER/1, PART=1\n" + graphics + CONTACT, 0.2, rtol=rtol)
    history = Mechanism([part.part() for part in parts], {}, [impact(nearest)], gravity=(0, 0, 0)).run(
        TIMES, 1e-10, max_step=1e-3
    )
    assert np.abs(np.diff(history.part(0)["vz"])).max() > 0.2
    for k in range(2):
        moves_alike(solution, f"PART_{k + 2}", history.part(k), tolerance)


class Flying:
    """A part that a dataset and the equations of the test share: numbers alone."""

    def __init__(self, mass, inertia, center, angles, velocity, spin):
        self.mass, self.inertia, self.center, self.angles = mass, np.diag(inertia), center, angles
        self.velocity, self.spin = velocity, spin

    def part(self):
        return Part(
            self.mass, tensor(*np.diag(self.inertia)), self.center, euler(*self.angles), self.velocity, self.spin
        )


def test_a_ball_on_a_flat_ellipsoid(tmp_path):
    """By the root of the secular equation, at an aspect of 20; damping ends the push for a moment, just before the solids part."""
    semi, radius = np.array([0.4, 0.1, 0.02]), 0.05
    inside = 0.999 * semi.min() ** 2

    def nearest(r, turns):
        local = turns[1].T @ (r[0] - r[1])
        at = brentq(lambda s: np.sum((semi * local / (s + semi**2)) ** 2) - 1, -inside, 10, xtol=1e-16, rtol=1e-15)
        foot = semi**2 * local / (at + semi**2)
        n = turns[1] @ ((local - foot) / np.linalg.norm(local - foot))
        gap = np.linalg.norm(local - foot) - radius
        return gap, r[0] - n * (radius + gap / 2), n

    parts = [
        Flying(1.5, (0.002, 0.002, 0.002), (0.1, 0.02, 0.09), (0, 0, 0), (0.2, 0, -0.7), (1, 8, 0)),
        Flying(2.0, (0.005, 0.08, 0.09), (0, 0, 0), (20, 10, 0), (0, 0, 0), (0, 0.5, 0.2)),
    ]
    graphics = """GRAPHICS/1, ELLIPSOID, CM=21, XSCALE=0.1, YSCALE=0.1, ZSCALE=0.1
GRAPHICS/2, ELLIPSOID, CM=31, XSCALE=0.8, YSCALE=0.2, ZSCALE=0.04
"""
    compare(tmp_path, graphics, parts, nearest, 2e-6, rtol=1e-7)


def test_two_cylinders_across_each_other(tmp_path):
    """By the common perpendicular of their axes."""

    def nearest(r, turns):
        a, b = turns[0][:, 2], turns[1][:, 2]
        n = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
        n = n if n @ (r[0] - r[1]) > 0 else -n
        gap = n @ (r[0] - r[1]) - 0.05 - 0.08
        lengths = np.linalg.solve(np.column_stack([a, -b, n]), r[1] - r[0])
        return gap, r[0] + lengths[0] * a - n * (0.05 + gap / 2), n

    parts = [
        Flying(1.5, (0.05, 0.05, 0.002), (0.02, 0.03, 0.15), (0, 90, 0), (0.2, 0.1, -1.5), (0, 1, 3)),
        Flying(2.0, (0.06, 0.06, 0.006), (0, 0, 0), (70, 90, 0), (0, 0, 0), (0, 0.5, 0.2)),
    ]
    graphics = """MARKER/22, PART=2, QP=0,0,-0.3
MARKER/32, PART=3, QP=0,0,0.3
GRAPHICS/1, CYLINDER, CM=22, LENGTH=0.6, RADIUS=0.05
GRAPHICS/2, CYLINDER, CM=32, LENGTH=-0.6, RADIUS=0.08
"""
    compare(tmp_path, graphics, parts, nearest, 2e-5)


def test_the_corner_of_a_box_on_the_face_of_another(tmp_path):
    """By the corner that is deepest under the face."""
    halves = np.array([0.1, 0.15, 0.05])
    corners = np.array(list(product(*([-1, 1],) * 3))) * halves

    def nearest(r, turns):
        n = turns[1][:, 2]
        places = r[0] + corners @ turns[0].T
        heights = (places - r[1]) @ n - 0.2
        k = int(np.argmin(heights))
        return heights[k], places[k] - n * heights[k] / 2, n

    parts = [
        Flying(1.5, (0.02, 0.01, 0.03), (0.1, 0.1, 0.36), (40, 35, 25), (0.2, 0, -1.5), (0, 0, 0)),
        Flying(4.0, (0.3, 0.3, 0.5), (0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0)),
    ]
    graphics = """MARKER/22, PART=2, QP=-0.1,-0.15,-0.05
MARKER/32, PART=3, QP=0.5,-0.5,-0.2
GRAPHICS/1, BOX, CORNER=22, X=0.2, Y=0.3, Z=0.1
GRAPHICS/2, BOX, CORNER=32, X=-1, Y=1, Z=0.4
"""
    compare(tmp_path, graphics, parts, nearest, 5e-4)
