"""Advice on what is held twice, judged by what the load does in the model that it advises."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs import spatial
from stiffmbs.analyses.check import check
from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.model.model_builder import ModelBuilder
from stiffmbs.reading.marker import Marker
from stiffmbs.redundancy.overconstraint import Overconstraint
from stiffmbs.redundancy.replacements import COMPONENTS

from ...case import Case, Outcome, Verdict, measured
from ...mechanisms.pendulum import GRAVITY

STIFF, DAMPING = 1e7, 2e4
"""N/m and N m/rad, N s/m and N m s/rad of a bushing in place of a joint: a load comes to rest within a second."""
HELD = {"revolute": (1, 1, 0), "prismatic": (0, 1, 1)}
"""What joints of the plane hold, along the axes of marker j."""


def door(hinges: int = 2) -> spatial.Model:
    """20 kg on hinges of one upright axis."""
    model = spatial.Model("Door", gravity=(0, 0, -GRAVITY))
    leaf = model.add("leaf", spatial.Body(mass=20, inertia=(3, 4, 1.2), position=(0.4, 0, 1)))
    for k, z in enumerate(np.linspace(-0.8, 0.8, hinges)):
        place = spatial.Marker(body="ground", point=(0, 0, 1 + z))
        model.add(f"hinge{k}", spatial.Revolute(i=leaf.at(-0.4, 0, z), j=place))
    return model


def table(segments: int = 4) -> spatial.Model:
    """10 kg on legs on a circle of 1 m."""
    model = spatial.Model("Table", gravity=(0, 0, -GRAVITY))
    top = model.add("top", spatial.Body(mass=10, inertia=(1, 1, 2), position=(0, 0, 1)))
    for k in range(segments):
        at = 2 * math.pi * k / segments
        foot = top.at(math.cos(at), math.sin(at), -1)
        model.add(f"leg{k}", spatial.PointOnPlane(i=foot, j="ground"))
    return model


def rails(count: int = 2) -> Model:
    """A block of 1 kg on parallel rails."""
    model = Model("Rails", gravity=(0, -GRAVITY))
    block = model.add("block", Body(mass=1, inertia=1))
    for k in range(count):
        model.add(f"rail{k}", JOINTS["prismatic"](i=block.at(0, k), j=Marker(body="ground", point=(0, k))))
    return model


def hanging(cranks: int = 3) -> Model:
    """A beam of 2 kg that hangs on massless parallel cranks, evenly spaced, its centre in the middle."""
    model = Model("Hanging beam", gravity=(0, -GRAVITY))
    middle = (cranks - 1) / 2
    beam = model.add("beam", Body(mass=2, inertia=1, position=(middle, -1)))
    for k in range(cranks):
        crank = model.add(f"crank{k}", Body(mass=1e-3, inertia=1e-3, position=(k, -0.5)))
        model.add(f"foot{k}", JOINTS["revolute"](i=crank.at(0, 0.5), j=Marker(body="ground", point=(k, 0))))
        model.add(f"head{k}", JOINTS["revolute"](i=crank.at(0, -0.5), j=beam.at(k - middle, 0)))
    return model


def _advised(model: ModelBuilder, case: Overconstraint, stiffness: np.ndarray) -> ModelBuilder:
    """The model with bushings in place of the joints that the advice names, each with its own stiffness."""
    in_space = isinstance(model, spatial.Model)
    other = type(model)(model.name, gravity=model.gravity)
    other.bodies = model.bodies
    joints: dict[str, Any] = model.joints
    for name, joint in joints.items():
        if name not in case.elastic:
            other.add(name, joint)
            continue
        held = [float(c in joint.transmits) for c in COMPONENTS] if in_space else HELD[joint.kind]
        k = float(stiffness[case.elastic.index(name)])
        bushing = spatial.Bushing if in_space else FORCES["bushing"]
        springs, dampers = (tuple(much * part for part in held) for much in (k, DAMPING))
        other.add(name, bushing(i=joint.i, j=joint.j, stiffness=springs, damping=dampers))
    return other


def _shared(
    scene: Callable[[], ModelBuilder], ratio: float, weight: float, places: Callable[[int], np.ndarray], channel: str
) -> Verdict:
    """The loads of elastic supports, the first `ratio` times as stiff, against those of a rigid body on springs."""
    model = scene()
    (case,) = check(model).overconstraints
    stiffness = STIFF * np.array([ratio, *np.ones(len(case.elastic) - 1)])
    if not len(case.elastic):
        return Verdict(Outcome.WRONG, detail=f"no advice on stiffness: {case.remedy}")
    solution = run(_advised(model, case, stiffness), duration=1.0, points=3, rtol=1e-7)
    if solution.not_unique:
        return Verdict(Outcome.WRONG, detail=f"not unique with the advice: {solution.not_unique}")
    B = places(len(case.elastic))
    loads = np.zeros(len(B))
    loads[0] = weight
    expected = stiffness * (np.linalg.solve((B * stiffness) @ B.T, loads) @ B)
    found = np.abs([solution[f"{name}.{channel}"][-1] for name in case.elastic])
    error = float(np.max(np.abs(found - np.abs(expected))) / weight)
    return measured(error, 1e-3, f"{', '.join(case.elastic)} carry {', '.join(f'{part:.4g}' for part in found)} N")


def _alike(count: int) -> np.ndarray:
    """Supports that yield by the same way."""
    return np.ones((1, count))


def _in_a_row(count: int) -> np.ndarray:
    """Supports under a beam."""
    return np.vstack([np.ones(count), np.arange(count) - (count - 1) / 2])


def _on_a_circle(count: int) -> np.ndarray:
    """Supports under a plate."""
    at = 2 * np.pi * np.arange(count) / count
    return np.vstack([np.ones(count), np.cos(at), np.sin(at)])


def _case(name: str, scene: Callable[[], ModelBuilder], ratio: float, weight: float, places: Callable[[int], np.ndarray], channel: str) -> Case:  # fmt: skip
    judge = partial(_shared, scene, ratio, weight * GRAVITY, places, channel)
    return Case(
        f"{name}, stiffness {ratio:g} to 1", "the advised bushings' loads against a rigid body on springs", judge
    )


CASES = (
    *(_case("door on two hinges", door, ratio, 20, _alike, "fz") for ratio in (1.0, 3.0, 0.1)),
    _case("door on three hinges", partial(door, 3), 5.0, 20, _alike, "fz"),
    _case("door on five hinges", partial(door, 5), 0.2, 20, _alike, "fz"),
    *(_case("table on four legs", table, ratio, 10, _on_a_circle, "fz") for ratio in (1.0, 0.1)),
    _case("table on six legs", partial(table, 6), 4.0, 10, _on_a_circle, "fz"),
    *(_case("block on two rails", rails, ratio, 1, _alike, "fy") for ratio in (1.0, 5.0)),
    _case("block on three rails", partial(rails, 3), 0.5, 1, _alike, "fy"),
    *(_case("beam on three cranks", hanging, ratio, 2, _in_a_row, "fy") for ratio in (1.0, 4.0)),
    _case("beam on five cranks", partial(hanging, 5), 0.25, 2, _in_a_row, "fy"),
)
