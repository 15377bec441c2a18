"""FRICTION of Adams datasets: loads times a coefficient that rises and falls over the speed by STEP5, on several kinds of joints."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.adams.load import read_adams
from stiffmbs.analyses.run import run

from ...variants.answers import compared

WEIGHT, STATIC, DYNAMIC, SLOW = 3 * 9.80665, 0.4, 0.3, 0.1
"""N, and the coefficients of friction with the velocity of transition, m/s."""
ALLOWED = 1e-6
HEAD = """a trial
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
ACCGRAV/KGRAV=-9.80665
MARKER/11, PART=1, REULER={turn}
PART/2, MASS=3, CM=21, IP=2e9,2e9,2e9, {start}
MARKER/21, PART=2
MARKER/22, PART=2, REULER={turn}
JOINT/1, {kind}, I=22, J=11
FRICTION/7, JOINT=1, MU_STATIC=0.4, MU_DYNAMIC=0.3, STICTION_TRANSITION_VELOCITY=0.1, {more}
END
"""
ACROSS, UP = "90D,90D,0D", "0D,0D,0D"
"""Euler angles by which z of a joint's markers is the ground's x, or stays upright."""
KINDS = {
    "ball": ("SPHERICAL", UP, "WX={w}", "BALL_RADIUS=0.5", 0.5, "FRICTION_7.tx", 0.5),
    "ball under a preload": ("SPHERICAL", UP, "WZ={w}", "BALL_RADIUS=0.5, FRICTION_TORQUE_PRELOAD=2", 0.5, "FRICTION_7.tz", 0.5),
    "pin across gravity": ("REVOLUTE", ACROSS, "WX={w}", "PIN_RADIUS=0.2, FRICTION_ARM=1", 0.2, "FRICTION_7.tx", 0.2),
    "pin along gravity": ("REVOLUTE", UP, "WZ={w}", "PIN_RADIUS=0.2, FRICTION_ARM=0.7", 0.2, "FRICTION_7.tz", 0.7),
    "guide": ("TRANSLATIONAL", ACROSS, "VX={v}", "INITIAL_OVERLAP=1, REACTION_ARM=1", 1.0, "FRICTION_7.fx", 1.0),
    "guide under a preload": ("TRANSLATIONAL", ACROSS, "VX={v}", "INITIAL_OVERLAP=1, REACTION_ARM=1, FRICTION_FORCE_PRELOAD=5", 1.0, "FRICTION_7.fx", 1.0),
    "sleeve that slides": ("CYLINDRICAL", ACROSS, "VX={v}", "INITIAL_OVERLAP=1, PIN_RADIUS=0.3", 1.0, "FRICTION_7.fx", 1.0),
    "sleeve that turns": ("CYLINDRICAL", ACROSS, "WX={w}", "INITIAL_OVERLAP=1, PIN_RADIUS=0.3", 0.3, "FRICTION_7_torque.tx", 0.3),
}  # fmt: skip
"""Statement, orientation, start, fields, radius of the speed, channel, and its arm of the weight."""
PRELOADS = {"ball under a preload": 2.0, "guide under a preload": 5.0}
"""N m and N, times STEP5 from -1 to 1 over the speed."""


def step5(x: float, x0: float, h0: float, x1: float, h1: float) -> float:
    """Return Adams' STEP5, a polynomial of fifth degree from (x0, h0) to (x1, h1)."""
    z = min(max((x - x0) / (x1 - x0), 0.0), 1.0)
    return h0 + (h1 - h0) * z**3 * (10 + z * (6 * z - 15))


def coefficient(v: float) -> float:
    """Return the coefficient at a speed."""
    if abs(v) < SLOW:
        return step5(v, -SLOW, -STATIC, SLOW, STATIC)
    return float(np.sign(v)) * step5(abs(v), SLOW, STATIC, 1.5 * SLOW, DYNAMIC)


def error(kind: str, ratio: float) -> float:
    """Return the relative error of the friction at the start, at a speed of a number of transition velocities."""
    statement, turn, start, more, radius, channel, arm = KINDS[kind]
    v = ratio * SLOW
    text = HEAD.format(kind=statement, turn=turn, more=more, start=start.format(v=repr(v), w=repr(v / radius)))
    found = run(read_adams(text), duration=1e-6, points=2)[channel][0]
    expected = -coefficient(v) * WEIGHT * arm - PRELOADS.get(kind, 0.0) * step5(v, -SLOW, -1, SLOW, 1)
    return abs(float(found) / expected - 1)


CASES = tuple(
    compared(f"{kind} at {ratio:g} of the velocity of transition", "STEP5", partial(error, kind, ratio), ALLOWED)
    for kind, ratios in zip(KINDS, ((0.557, 1.2), (0.1, -0.7), (0.3, 1.45), (-0.557, 1.01), (0.8, -1.3), (0.557, 1.6), (0.05, 1.2), (-0.9, 2.0)), strict=True)
    for ratio in ratios
)  # fmt: skip
