"""Energy balances against closed forms of the work, and no note on a run that is right."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model import spatial_model as spatial
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from ...case import Case, Outcome, Verdict, measured


def on_rail(**spring: Any) -> Model:
    """2 kg on a rail and a spring of 50 N/m, 0.3 m from its rest."""
    model = Model("Sled on a spring")
    model.add("sled", Body(mass=2, inertia=1, position=(1.3, 0)))
    model.add("rail", JOINTS["prismatic"](i="sled", j="ground"))
    post = Marker(body="ground", point=(-1, 0))
    model.add("spring", FORCES["spring_damper"](i="sled", j=post, stiffness=50, free_length=2, **spring))
    return model


def pushed(force: str) -> Model:
    """2 kg on a rail under a force over time."""
    model = Model("Pushed sled")
    model.add("sled", Body(mass=2, inertia=1))
    model.add("rail", JOINTS["prismatic"](i="sled", j="ground"))
    model.add("push", FORCES["force"](i="sled", force=(force, 0)))
    return model


def lifted(**law: Any) -> Model:
    """3 kg on an upright rail, moved by a drive against gravity."""
    model = Model("Lift", gravity=(0, -9.81))
    model.add("cabin", Body(mass=3, inertia=1, angle=np.pi / 2))
    model.add("rail", JOINTS["prismatic"](i="cabin", j=Marker(body="ground", angle=np.pi / 2)))
    model.add("motor", JOINTS["drive"](joint="rail", **law))
    return model


def rubbing() -> Model:
    """1 kg that slides at 3 m/s on a guide with a coefficient of friction of 0.2, and comes to rest."""
    model = Model("Sliding block", gravity=(0, -9.81))
    model.add("block", Body(mass=1, inertia=1, velocity=(3, 0)))
    model.add("guide", JOINTS["prismatic"](i="block", j="ground"))
    model.add("rubs", FORCES["joint_friction"](joint="guide", friction=0.2))
    return model


def spun() -> spatial.Model:
    """1 kg m^2 on a hinge in space with a damper of 0.5 N m s/rad, at 4 rad/s."""
    model = spatial.Model("Spun wheel")
    model.add("wheel", spatial.Body(mass=1, inertia=(1, 1, 1), omega=(0, 0, 4)))
    model.add("hinge", spatial.JOINTS["revolute"](i="wheel", j="ground"))
    model.add("brake", spatial.FORCES["torsion_spring"](i="wheel", j="ground", damping=0.5))
    return model


def bouncing() -> Model:
    """1 kg that falls from 1 m on a floor of Hertz's law with dissipation: all its energy goes there."""
    model = Model("Bouncing ball", gravity=(0, -9.81))
    model.add("ball", Body(mass=1, inertia=1, position=(0, 1)))
    model.add("floor", FORCES["contact"](i="ball", j="ground", stiffness=1e6, dissipation=2.0))
    return model


def _judged(scene: Callable[[], Any], work: Callable[[Solution], float], how: dict[str, Any]) -> Verdict:
    solution = run(scene(), **how)
    if solution.notes:
        return Verdict(Outcome.WRONG, detail=f"a note on a run that is right: {'; '.join(solution.notes)}")
    balance = solution.balance
    expected = work(solution)
    off = abs(float(balance.work[-1]) - expected) / balance.scale
    return measured(max(off, balance.imbalance / balance.scale), 1e-4, f"{balance.work[-1]:.6g} J of {expected:.6g} J")


def _case(name: str, scene: Callable[[], Any], work: Callable[[Solution], float], **how: Any) -> Case:
    return Case(name, "work of what has no potential, against its closed form", partial(_judged, scene, work, how))


def _decayed(solution: Solution) -> float:
    """Of a damper: what is left of the energy at the end, less 50 N/m (0.3 m)^2 / 2."""
    x, v = solution["sled.x"][-1] - 1.0, solution["sled.vx"][-1]
    return float(25 * x**2 + v**2 - 25 * 0.3**2)


CASES = (
    _case("damped oscillator", partial(on_rail, damping=3.0), _decayed, duration=3.0, rtol=1e-8),
    _case("damped oscillator, dop853", partial(on_rail, damping=3.0), _decayed, duration=3.0, rtol=1e-8, solver="projected", scheme="dop853"),
    _case("damped oscillator, few output points", partial(on_rail, damping=3.0), _decayed, duration=3.0, rtol=1e-8, points=201),
    _case("damper over the rate cubed", partial(on_rail, damper_law="5*v^3"), _decayed, duration=3.0, rtol=1e-8),
    _case("force of sin(3 t)", partial(pushed, "4*sin(3*t)"), lambda s: float((4 / 3 * (1 - np.cos(3 * s.t[-1]))) ** 2 / 4), duration=5.0, rtol=1e-8),
    _case("lift by a drive of its place", partial(lifted, position="t^2*(3 - 2*t)"), lambda s: 3 * 9.81, duration=1.0, rtol=1e-8),
    _case("lift by a drive of its speed", partial(lifted, velocity="6*t*(1 - t)"), lambda s: 3 * 9.81, duration=1.0, rtol=1e-8),
    _case("lift, kinematic", partial(lifted, position="t^2*(3 - 2*t)"), lambda s: 3 * 9.81, duration=1.0, solver="kinematic"),
    _case("block with friction", rubbing, lambda s: -0.5 * (9 - float(s["block.vx"][-1]) ** 2), duration=2.0, rtol=1e-8, points=4001),
    _case("braked wheel in space", spun, lambda s: -8 * (1 - float(np.exp(-s.t[-1]))), duration=3.0, rtol=1e-8),
    _case("undamped oscillator", on_rail, lambda s: 0.0, duration=3.0, rtol=1e-8),
    _case("bouncing ball at the solver's steps", bouncing, lambda s: float(s["energy.total"][-1] - s["energy.total"][0]), duration=1.5, rtol=1e-8, points="steps"),
)  # fmt: skip
