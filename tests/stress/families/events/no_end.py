"""Motions that come to no end, told by every solver in the same words; and quick ones that do end, against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...mechanisms.pendulum import GRAVITY
from ...simulation import simulation

SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"}, "auto": {"solver": "auto"}, "dop853": {"solver": "projected", "scheme": "dop853"},
    "dopri5": {"solver": "projected", "scheme": "dopri5"},
}  # fmt: skip


def block(law: str, **body: Any) -> Model:
    """1 kg on a rail along x under one force."""
    model = Model("Block")
    model.add("block", Body(mass=1, inertia=1, **body))
    model.add("rail", JOINTS["prismatic"](i="block", j="ground"))
    model.add("push", FORCES["force"](i="block", force=(law, 0)))
    return model


def wheel(law: str) -> Model:
    """0.1 kg m^2 on a pin under one torque."""
    model = Model("Wheel")
    model.add("wheel", Body(mass=1, inertia=0.1))
    model.add("pin", JOINTS["revolute"](i="wheel", j="ground"))
    model.add("push", FORCES["torque"](i="wheel", torque=law))
    return model


def held_pendulum() -> Model:
    """A pendulum that dry friction holds at rest."""
    model = Model("Pendulum", gravity=(0, -GRAVITY))
    bob = model.add("bob", Body(mass=1, inertia=0.1, position=(1, 0)))
    model.add("pin", JOINTS["revolute"](i=bob.at(-1, 0), j="ground"))
    model.add("push", FORCES["torque"](i="bob", torque="-4*sign(bob.omega)"))
    return model


def bouncing_on_a_jump() -> Model:
    """A ball on a floor that pushes with a constant force, less on the way up: its bounces come ever faster."""
    model = Model("Ball", gravity=(0, -GRAVITY))
    model.add("ball", Body(mass=1, inertia=1, position=(0, 0.2)))
    model.add("push", FORCES["force"](i="ball", force=(0, "branch(ball.y, 200, 0, 0)*(1 - 0.2*sign(ball.vy))")))
    return model


def spun_up() -> Model:
    """A torque that follows a marker's velocity spins the body ever faster: its law changes twice in each turn."""
    model = Model("Spun up", gravity=(0, -GRAVITY))
    markers = {"m": {"point": (0.28, -0.22)}}
    body = Body(
        mass=1, inertia=0.04, position=(-0.2, -0.7), angle=-2.87, velocity=(-0.9, -0.4), omega=-1.6, markers=markers
    )
    model.add("body", body)
    law = "branch(-vy(body.m) - 0.1, 5.66*vy(body.m), 0, -0.566 - 3*(vy(body.m) + 0.1))"
    model.add("push", FORCES["torque"](i="body", torque=law))
    return model


def driven_against_a_stop() -> Model:
    """A motor pushes a slider at 0.1 m/s against a stop of 1e6 N/m from 0.5 m on."""
    model = Model("Stop")
    model.add("slider", Body(mass=1, inertia=1))
    model.add("rail", JOINTS["prismatic"](i="slider", j="ground"))
    model.add("motor", JOINTS["drive"](joint="rail", position="0.1*t"))
    stop = Marker(body="ground", point=(0.5, 0), angle=np.pi / 2)
    model.add("stop", FORCES["contact"](i="slider", j=stop, stiffness=1e6, exponent=1.0))
    return model


def _until_rest(solution: Solution) -> float:
    """x = t - 2.5 t^2 until 0.2 s, m."""
    moving = solution.t <= 0.2
    return float(np.max(np.abs(solution["block.x"] - solution.t + 2.5 * solution.t**2)[moving]))


def _nothing(solution: Solution) -> float:
    return 0.0


def _relay(solution: Solution) -> float:
    """x'' = -5 sign(x) from x = 0 at 0.1 m/s: arches of 0.04 s, parabolas, relative to their height of 1 mm."""
    t = np.mod(solution.t, 0.08)
    arch = np.where(t < 0.04, t, t - 0.04)
    expected = np.where(t < 0.04, 1.0, -1.0) * (0.1 * arch - 2.5 * arch**2)
    return float(np.max(np.abs(solution["block.x"] - expected)) / 1e-3)


def _stop_force(solution: Solution) -> float:
    """The motor's force against 1e6 N/m times the way beyond the stop, N."""
    expected = -1e6 * np.maximum(0.0, 0.1 * solution.t - 0.5)
    return float(np.max(np.abs(np.abs(solution["motor.fx"]) + expected)))


JUMPS: dict[str, tuple[Callable[[], Model], Callable[[Solution], float]]] = {
    "sign(v) at rest": (partial(block, "-5*sign(block.vx)", velocity=(1, 0)), _until_rest),
    "sign(v), pulled from the start": (partial(block, "3 - 5*sign(block.vx)"), _nothing),
    "a block on a belt": (partial(block, "-5*sign(block.vx - 1) - 20*block.x"), _nothing),
    "a speed kept by a relay": (partial(wheel, "branch(wheel.omega - 5, 3, 0, -3)"), _nothing),
    "a switching line": (partial(block, "branch(block.x + block.vx, 9, 0, -9)", position=(1, 0)), _nothing),
    "a pendulum held by friction": (held_pendulum, _nothing),
    "bounces on a jump": (bouncing_on_a_jump, _nothing),
}
FASTER = {"a body spun up": spun_up}


def _told(name: str, scene: Callable[[], Model], error: Callable[[Solution], float], words: str, solver: str):
    return simulation(
        f"{name}, {solver}", "ends in the same words by every solver", scene, error, 1e-5, names=("'push'", words, "t = "),
        expected=Outcome.TOLD, duration=4.0, points=401, **SOLVERS[solver],
    )  # fmt: skip


CASES = (
    *(_told(name, *of, "chatters", solver) for name, of in JUMPS.items() for solver in SOLVERS),
    *(_told(name, scene, _nothing, "chatters", solver) for name, scene in FASTER.items() for solver in SOLVERS),
    *(
        simulation(
            f"sign(v) at rest, {scheme} in steps of 1 ms", "the jump is noted", JUMPS["sign(v) at rest"][0], _until_rest, 5e-3,
            noted=("'push' chatters",), expected=Outcome.TOLD, duration=1.0, points=101, solver="projected", scheme=scheme,
        )
        for scheme in ("rk4", "euler_cromer")
    ),
    *(
        simulation(
            f"a relay that swings, {solver}", "x'' = -5 sign(x), 250 changes; way against parabolas",
            partial(block, "-5*sign(block.x)", velocity=(0.1, 0)), _relay, 5e-3, duration=10.0, points=401, rtol=1e-9, **SOLVERS[solver],
        )
        for solver in ("bdf", "dop853")
    ),
    *(
        simulation(
            f"a motor that pushes against a stop, {solver}", "force against the stop's", driven_against_a_stop, _stop_force, 1e-3,
            duration=10.0, points=101, **SOLVERS[solver],
        )
        for solver in SOLVERS
    ),
)  # fmt: skip
