"""MuJoCo by its explicit Runge-Kutta method of order 4."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from ...contestant import Contestant, Failed, Solve
from .tree import GROUND, Tree

PARTS = (*(1 / part for part in (10, 5, 4, 2)), *(1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256))
"""Steps from one output time to the next."""


def contestants(tree: Tree) -> Iterator[Contestant]:
    """Steps of one length."""
    spacing = float(tree.times[1] - tree.times[0])
    steps = tuple(spacing / part for part in PARTS)
    yield Contestant("MuJoCo RK4", True, lambda step: marching(tree, spacing, step), "step", steps)


def model_of(tree: Tree) -> Any:
    """MuJoCo's model; the hinges of links without a mass belong to the link that they carry."""
    import mujoco

    root = xml.Element("mujoco")
    xml.SubElement(root, "compiler", angle="radian")
    option = xml.SubElement(root, "option", integrator="RK4", gravity=_text(tree.gravity))
    xml.SubElement(option, "flag", contact="disable", constraint="disable")
    bodies = {GROUND: xml.SubElement(root, "worldbody")}
    for k, link in enumerate(tree.links):
        joined = link.parent != GROUND and not tree.links[link.parent].mass
        body = (
            bodies[link.parent]
            if joined
            else xml.SubElement(bodies[link.parent], "body", pos=_text(tree.from_parent(k)))
        )
        bodies[k] = body
        xml.SubElement(body, "joint", type="hinge", axis=_text(link.axis), damping=repr(link.damping))
        if link.mass:
            tensor = link.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
            centre = _text(link.centre - link.hinge)
            xml.SubElement(body, "inertial", pos=centre, mass=repr(link.mass), fullinertia=_text(tensor))
    return mujoco.MjModel.from_xml_string(xml.tostring(root, encoding="unicode"))


def at_start(tree: Tree) -> Callable[[], np.ndarray]:
    """The accelerations of the hinges by `mj_forward`, at the start."""
    import mujoco

    model = model_of(tree)
    data = mujoco.MjData(model)
    data.qvel[:] = tree.rates

    def accelerations() -> np.ndarray:
        mujoco.mj_forward(model, data)
        return np.asarray(data.qacc)

    return accelerations


def _text(numbers: np.ndarray) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def marching(tree: Tree, spacing: float, step: float) -> Solve:
    """Steps of one length; nan at the output times that they pass over."""
    import mujoco

    model, bad = model_of(tree), mujoco.mjtWarning
    model.opt.timestep = step
    mujoco.set_mju_user_warning(lambda sentence: None)  # it would write a file of its own
    every, count = max(1, round(step / spacing)), max(1, round(spacing / step))

    def solve() -> np.ndarray:
        """The angles at the output times."""
        data = mujoco.MjData(model)
        data.qvel[:] = tree.rates
        angles = np.full((len(tree.times), len(tree.links)), np.nan)
        angles[0] = 0.0
        for k in range(every, len(tree.times), every):
            mujoco.mj_step(model, data, count)
            angles[k] = data.qpos
        if any(data.warning[kind].number for kind in (bad.mjWARN_BADQPOS, bad.mjWARN_BADQVEL, bad.mjWARN_BADQACC)):
            raise Failed("the motion became too fast")
        return tree.places(angles)

    return solve
