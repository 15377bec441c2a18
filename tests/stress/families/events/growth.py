"""Motions that diverge, which are told, and motions that are only large or fast, which are not."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.errors import StiffmbsError
from stiffmbs.model import spatial_model as spatial
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...case import Case, Outcome, Verdict, measured


def tied(**spring: Any) -> Model:
    """2 kg tied to the ground by a spring-damper, with a rod of 1 kg on it."""
    model = Model("Tied", gravity=(0, -9.81))
    model.add("a", Body(mass=2, inertia=0.1, position=(0.5, 0)))
    model.add("b", Body(mass=1, inertia=0.1, position=(1.5, 0)))
    model.add("rope", JOINTS["distance"](i="a", j="b", length=1))
    model.add("spring", FORCES["spring_damper"](i="a", j="ground", **spring))
    return model


def hinged(**spring: Any) -> Model:
    """A bar on a hinge with a torsion spring."""
    model = Model("Hinged", gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=2, inertia=0.1, position=(0.5, 0)))
    model.add("hinge", JOINTS["revolute"](i=bar.at(-0.5, 0), j="ground"))
    model.add("spring", FORCES["torsion_spring"](i="bar", j="ground", **spring))
    return model


def held(**bushing: Any) -> Model:
    """A block in a bushing."""
    model = Model("Held", gravity=(0, -9.81))
    model.add("block", Body(mass=2, inertia=0.1, position=(0.1, 0)))
    model.add("bushing", FORCES["bushing"](i="block", j="ground", **bushing))
    return model


def pushed(
    *force: str | float, gravity: tuple[float, float] = (0, -9.81), velocity: tuple[float, float] = (3, 20)
) -> Model:
    """A body that nothing holds, under a force."""
    model = Model("Pushed", gravity=gravity)
    model.add("body", Body(mass=2, inertia=0.1, velocity=velocity, omega=10))
    if force:
        model.add("push", FORCES["force"](i="body", force=force))
    return model


def chased() -> spatial.Model:
    """A body in space under a force that grows with its way."""
    model = spatial.Model("Chased")
    model.add("body", spatial.Body(mass=1, inertia=(1, 1, 1), position=(0, 0, 0.1)))
    model.add("push", spatial.FORCES["force"](i="body", force=(0, 0, "900*body.z")))
    return model


def two_falling() -> Model:
    """Two bodies on a pin, let fall."""
    model = Model("Falling pair", gravity=(0, -9.81))
    a = model.add("a", Body(mass=1, inertia=0.1))
    b = model.add("b", Body(mass=1, inertia=0.1, position=(1, 0)))
    model.add("pin", JOINTS["revolute"](i=a.at(0.5, 0), j=b.at(-0.5, 0)))
    return model


def spun_up() -> Model:
    """A wheel that a motor brings to 20 000 rad/s."""
    model = Model("Rotor")
    model.add("wheel", Body(mass=1, inertia=0.01))
    model.add("pin", JOINTS["revolute"](i="wheel", j="ground"))
    model.add("motor", FORCES["torque"](i="wheel", torque="20*step(t, 0, 0, 2, 1)"))
    return model


def _judged_growth(scene: Callable[[], Any], how: dict[str, Any]) -> Verdict:
    """Told where notes or the message say that it grows, or that energy comes from nowhere."""
    try:
        solution = run(scene(), **how)
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=str(refusal))
    words = "; ".join((solution.message, *solution.notes))
    said = any(sentence in words for sentence in ("diverges", "energy balance is broken"))
    return Verdict(Outcome.TOLD if said else Outcome.WRONG, detail=words)


def _judged_sense(scene: Callable[[], Any], error: Callable[[Solution], float], how: dict[str, Any]) -> Verdict:
    """Right where there is no note, and the motion is that of the closed form."""
    solution = run(scene(), **how)
    if solution.notes:
        return Verdict(Outcome.WRONG, detail=f"a note on a motion that makes sense: {'; '.join(solution.notes)}")
    return measured(error(solution), 1e-5, solution.message)


def _growing(name: str, scene: Callable[[], Any], **how: Any) -> Case:
    return Case(name, "a note or the message says that it diverges", partial(_judged_growth, scene, how), Outcome.TOLD)


def _sensible(name: str, scene: Callable[[], Any], error: Callable[[Solution], float], **how: Any) -> Case:
    return Case(name, "no note; against the closed form", partial(_judged_sense, scene, error, how))


def _fallen(solution: Solution) -> float:
    """Of the way of a thrown body, relative to it."""
    expected = 20 * solution.t - 9.81 / 2 * solution.t**2
    return float(np.max(np.abs(solution["body.y"] - expected)) / np.max(np.abs(expected)))


CASES = (
    _growing("spring of wrong sign", partial(tied, stiffness=-1e4, free_length=0.4), duration=5.0),
    _growing("spring of wrong sign, explicit", partial(tied, stiffness=-1e4, free_length=0.4), duration=5.0, solver="projected", scheme="dop853"),
    _growing("spring of wrong sign, fixed steps", partial(tied, stiffness=-1e4, free_length=0.4), duration=1.0, solver="projected", scheme="rk4"),
    _growing("spring of wrong sign, short", partial(tied, stiffness=-200, free_length=0.4), duration=2.5),
    _growing("torsion spring of wrong sign", partial(hinged, stiffness=-2000), duration=10.0),
    _growing("torsion spring of wrong sign, auto", partial(hinged, stiffness=-2000), duration=10.0, solver="auto"),
    _growing("damper of wrong sign", partial(tied, stiffness=100, free_length=0.4, damping=-20), duration=9.0),
    _growing("bushing of wrong sign", partial(held, stiffness=(-4e4, 1e4, 100)), duration=2.0),
    _growing("force that grows with the way, in space", chased, duration=4.0),
    _sensible("thrown body", pushed, _fallen, duration=3.0),
    _sensible("body that falls for an hour", pushed, _fallen, duration=3600.0),
    _sensible(
        "rocket", partial(pushed, "0", "60*step(t, 10, 0, 40, 1)"), lambda s: abs(float(s["body.x"][-1]) / (3 * 4000) - 1), duration=4000.0, rtol=1e-8,
    ),
    _sensible("rotor at 20 000 rad/s", spun_up, lambda s: abs(float(s["wheel.omega"][-1]) / (2000 * (11 - 1)) - 1), duration=11.0, points=101),
    _sensible(
        "pair that falls for 1000 s", two_falling, lambda s: abs(float((s["a.y"] + s["b.y"])[-1]) / (-9.81 * 1e6) - 1), duration=1000.0, points=101, rtol=1e-8,
    ),
)  # fmt: skip
