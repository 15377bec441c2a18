"""Friction at rest and the start of sliding: creep and slip in closed form."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from ...mechanisms.pendulum import GRAVITY
from ...simulation import refusal, simulation

MU, CREEP = 0.3, 1e-4


def block(pull: str) -> Model:
    """1 kg on a rail with friction, pulled by a force relative to what friction can hold."""
    model = Model("Block", gravity=(0, -GRAVITY))
    model.add("block", Body(mass=1, inertia=1))
    model.add("rail", JOINTS["prismatic"](i="block", j="ground"))
    model.add("rub", FORCES["joint_friction"](joint="rail", friction=MU, stiction_velocity=CREEP))
    model.add("pull", FORCES["force"](i="block", force=(f"{MU * GRAVITY}*({pull})", 0)))
    return model


def _drift(solution: Solution, part: float) -> float:
    """Against the speed at which smooth friction holds the pull: mu tanh(v/v_s) = part mu, relative to v_s."""
    return float(np.max(np.abs(solution["block.vx"][1:] / CREEP - np.arctanh(part))[len(solution.t) // 10 :]))


def _slip(solution: Solution) -> float:
    """Pulled twice as hard as friction holds: x = mu g t^2/2, but for the creeping start; in m."""
    return float(np.max(np.abs(solution["block.x"] - MU * GRAVITY / 2 * solution.t**2)))


def _stopped(solution: Solution) -> float:
    """Pulled with 2 for a second and with 0 from then on: rest after 2 s, MU g/2 m from the start in each of the seconds."""
    return float(abs(solution["block.x"][-1] - MU * GRAVITY))


def jammed() -> Model:
    """A guide of length l that rubs at an arm h jams where mu exceeds l/(2 h)."""
    model = Model("Jam", gravity=(0, -GRAVITY))
    model.add("block", Body(mass=1, inertia=0.01, velocity=(-0.5, 0)))
    i, j = (Marker(body=body, point=(0, -1)) for body in ("block", "ground"))
    model.add("guide", JOINTS["prismatic"](i=i, j=j))
    model.add("rub", FORCES["joint_friction"](joint="guide", friction=0.5, length=0.01))
    return model


CASES = (
    *(
        simulation(
            f"block held at {part:g} of what friction holds", "speed against the creep of smooth friction, relative to v_s",
            partial(block, str(part)), partial(_drift, part=part), 1e-3, duration=10.0, points=101, rtol=1e-6,
        )
        for part in (0.0, 0.5, 0.9, 0.999)
    ),
    simulation(
        "block pulled twice as hard", "way against mu g t^2/2", partial(block, "2"), _slip, 1e-4,
        duration=1.0, points=101, rtol=1e-8,
    ),
    simulation(
        "block that comes to rest", "way against mu g", partial(block, "2*(1 - step(t, 1, 0, 1 + 1e-9, 1))"), _stopped, 1e-3,
        duration=3.0, points=301, rtol=1e-8,
    ),
    refusal("a joint that jams", "friction and the reactions that press it have no balance", jammed, ("rub", "no unique solution")),
)  # fmt: skip
