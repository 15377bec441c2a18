"""Constraints with formulas that are flat in floating point where the motion starts, against energy by quadrature.

The derivatives of tanh, exp and log(cosh) are exactly zero, or exactly one, over wide ranges, and those of dwells are
so by design.  A presolve that asks values takes such an equation for one with constant coefficients.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import expit

from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.solution import Solution

from ...case import Case, Outcome
from ...simulation import simulation

GRAVITY = 9.81
SPEED = 10.0
"""Of the first body at the start, m/s or rad/s."""
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "without presolve": {"solver": "bdf", "presolve": False},
    "dop853": {"solver": "projected", "scheme": "dop853"},
}


@dataclass(frozen=True)
class Law:
    """A law over the way s of the first body: its text, with WAY for s, its value and its slope."""

    name: str
    text: str
    value: Callable[[float], float]
    slope: Callable[[float], float]
    tables: str = ""


@dataclass(frozen=True)
class Mechanism:
    """A first body, b, whose way moves a second mass, or itself, by a law.

    Attributes
    ----------
    text : str
        The scene, with LAW for the law and RATE for the rate that it has at the start.
    way : str
        The way in formulas.
    channel : str
        The same in results.
    weight : float
        The acceleration, m/s^2, against which the law lifts the mass.
    """

    name: str
    text: str
    way: str = "b.x"
    channel: str = "b.x"
    weight: float = 0.0


SLOT = Mechanism("slot", """
gravity: [0, -9.81]
bodies: {b: {mass: 1, inertia: 1, velocity: [10, RATE]}}
joints: {slot: {type: point_on_curve, i: b, j: ground, y: "LAW"}}
""", way="x", weight=GRAVITY)  # fmt: skip
EQUATION = Mechanism("equation", """
gravity: [0, -9.81]
bodies: {b: {mass: 1, inertia: 1, velocity: [10, RATE]}}
joints: {path: {type: equation, zero: "b.y - LAW"}}
""", weight=GRAVITY)  # fmt: skip
SLOT_IN_SPACE = Mechanism("slot in space", """
dimensions: 3
gravity: [0, 0, -9.81]
bodies: {b: {mass: 1, inertia: [1, 1, 1], velocity: [10, 0, 0]}}
joints: {slot: {type: point_on_curve, i: b, j: {body: ground, orientation: {x: [1, 0, 0], y: [0, 0, 1]}}, y: "LAW"}}
""", way="x", weight=GRAVITY)  # fmt: skip
COUPLED = Mechanism("two sleds", """
bodies:
  b: {mass: 1, inertia: 1, velocity: [10, 0]}
  c: {mass: 1, inertia: 1, velocity: [RATE, 0]}
joints:
  rail: {type: prismatic, i: b, j: ground}
  other_rail: {type: prismatic, i: c, j: ground}
  coupling: {type: equation, zero: "c.x - LAW"}
""")  # fmt: skip
CAM = Mechanism("cam", """
gravity: [0, -9.81]
bodies:
  b: {mass: 1, inertia: 1, omega: 10}
  c: {mass: 1, inertia: 1, angle: 90 deg}
joints:
  shaft: {type: revolute, i: b, j: ground}
  guide: {type: prismatic, i: c, j: {body: ground, angle: 90 deg}}
  follower: {type: equation, zero: "c.y - LAW"}
""", way="b.angle", channel="b.angle", weight=GRAVITY)  # fmt: skip
TURNED = Mechanism("turned in space", """
dimensions: 3
bodies:
  b: {mass: 1, inertia: [1, 1, 1], velocity: [10, 0, 0]}
  c: {mass: 1, inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, i: {body: b, orientation: {z: [1, 0, 0]}}, j: {body: ground, orientation: {z: [1, 0, 0]}}}
  upright: {type: parallel, i: c, j: ground}
  turning: {type: equation, zero: "az(c) - LAW"}
""")  # fmt: skip


def _smooth(s: float) -> float:
    z = np.clip((s - 4) / 1.5, 0, 1)
    return float(0.3 * z**3 * (10 - 15 * z + 6 * z * z))


def _smooth_slope(s: float) -> float:
    z = np.clip((s - 4) / 1.5, 0, 1)
    return float(6 * z**2 * (1 - z) ** 2)


RAMP = Law(
    "tanh", "(1 + tanh(20*(WAY - 5)))", lambda s: 1 + np.tanh(20 * (s - 5)), lambda s: 20 / np.cosh(20 * (s - 5)) ** 2
)
BUMP = Law(
    "Gaussian bump", "(1.5*exp(-((WAY - 5)/0.5)^2))", lambda s: 1.5 * np.exp(-4 * (s - 5) ** 2),
    lambda s: -12 * (s - 5) * np.exp(-4 * (s - 5) ** 2),
)  # fmt: skip
LOGISTIC = Law(
    "logistic", "(1/(1 + exp(-30*(WAY - 4))))", lambda s: expit(30 * (s - 4)),
    lambda s: 30 * expit(30 * (s - 4)) * expit(30 * (4 - s)),
)  # fmt: skip
BEND = Law(
    "log(cosh)", "(log(2*cosh(20*(WAY - 5)))/20 - 5)", lambda s: np.logaddexp(20 * (s - 5), 20 * (5 - s)) / 20 - 5,
    lambda s: np.tanh(20 * (s - 5)),
)  # fmt: skip
DWELL = Law("dwells by step5", "step5(WAY, 4, 0, 5.5, 0.3)", _smooth, _smooth_slope)
TABLE = Law(
    "dwells in a table", "p(WAY)", _smooth, _smooth_slope,
    f"tables: {{p: {{table: {[[s / 100, _smooth(s / 100)] for s in range(-200, 1500)]}, spline: true}}}}\n",
)  # fmt: skip
ZERO = Law("products with zero", "(0*WAY + 0*WAY^2 + 0*sin(WAY))", lambda s: 0.0, lambda s: 0.0)
PAIRS = (
    (SLOT, RAMP), (SLOT, BUMP), (SLOT, BEND), (SLOT, ZERO), (EQUATION, LOGISTIC), (EQUATION, TABLE), (COUPLED, RAMP), (COUPLED, BEND),
    (CAM, DWELL), (CAM, TABLE), (SLOT_IN_SPACE, RAMP), (SLOT_IN_SPACE, BUMP), (TURNED, RAMP), (TURNED, LOGISTIC),
)  # fmt: skip


def _scene(mechanism: Mechanism, law: Law) -> Scene:
    formula, rate = law.text.replace("WAY", mechanism.way), repr(float(SPEED * law.slope(0.0)))
    return read_scene(mechanism.text.replace("LAW", formula).replace("RATE", rate) + law.tables)


def _astray(solution: Solution, mechanism: Mechanism, law: Law) -> float:
    """Largest error of the way s: s'^2 (1 + Y'(s)^2) + 2 g Y(s) keeps its value, from which s' follows."""

    def parts(s: float) -> tuple[float, float]:
        return 1 + law.slope(s) ** 2, 2 * mechanism.weight * law.value(s)

    inertia, height = parts(0.0)
    energy = SPEED**2 * inertia + height

    def speed(_: float, s: np.ndarray) -> list[float]:
        inertia, height = parts(s[0])
        return [np.sqrt((energy - height) / inertia)]

    t = solution.t
    expected = solve_ivp(speed, (0, t[-1]), [0.0], "DOP853", t_eval=t, rtol=1e-9, atol=1e-9, max_step=2e-3).y[0]
    return float(np.max(np.abs(solution[mechanism.channel] - expected)))


def _case(mechanism: Mechanism, law: Law, solver: str) -> Case:
    return simulation(
        f"{mechanism.name}, {law.name}, {solver}", "way against energy by quadrature", partial(_scene, mechanism, law),
        partial(_astray, mechanism=mechanism, law=law), 1e-4, quick="dimensions: 3" not in mechanism.text,
        duration=1.0, points=101, rtol=1e-8, **SOLVERS[solver],
    )  # fmt: skip


RAILS = """
bodies: {b: {mass: 1, inertia: 1, velocity: [10, 0]}}
joints:
  rail: {type: point_on_line, i: b, j: ground}
  bumpy: {type: point_on_curve, i: b, j: ground, y: "0.3*exp(-((x - 5.03)/0.1)^2)"}
"""
DRIVES = """
bodies: {b: {mass: 1, inertia: 1}}
joints:
  rail: {type: prismatic, i: b, j: ground}
  still: {type: drive, joint: rail, position: 0*t}
  pulse: {type: drive, joint: rail, position: "exp(-((t - 0.73)/0.5 ms)^2)"}
"""


def _told(name: str, what: str, text: str, joint: str, speed: float) -> Case:
    """A case in which two joints hold the same at the start and contradict each other later."""
    return simulation(
        name, what, partial(read_scene, text), lambda solution: float(np.max(np.abs(solution["b.x"] - speed * solution.t))), 1e-9,
        names=(f"joint '{joint}'", "is violated"), expected=Outcome.TOLD, duration=1.0, points=11,
    )  # fmt: skip


CASES = (
    *(_case(mechanism, law, solver) for mechanism, law in PAIRS for solver in SOLVERS),
    _told("a straight rail and one with a bump", "told where the second one rises; way before", RAILS, "bumpy", SPEED),
    _told("two drives, one with a pulse of 1 ms", "told where they part; way before", DRIVES, "pulse", 0.0),
)
