"""Accelerations by MuJoCo and by this package at the same state; both without contacts, limits and soft constraints."""

from pathlib import Path

import mujoco
import numpy as np

import stiffmbs
from stiffmbs.robots.load import load_robot

ONE_COORDINATE = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))


def compiled(text_or_path):
    """MuJoCo's model of a file's path, or of text."""
    make = mujoco.MjModel.from_xml_path if isinstance(text_or_path, Path) else mujoco.MjModel.from_xml_string
    m = make(str(text_or_path))
    off = mujoco.mjtDisableBit
    m.opt.disableflags |= off.mjDSBL_CONTACT | off.mjDSBL_LIMIT | off.mjDSBL_FRICTIONLOSS | off.mjDSBL_EQUALITY
    m.opt.density = m.opt.viscosity = 0
    return m


def random_state(m, rng):
    """Coordinates and rates of the hinges and slides by name, within their limits, and the inputs of the actuators."""
    coordinates, rates = {}, {}
    for k in range(m.njnt):
        if int(m.jnt_type[k]) in ONE_COORDINATE:
            low, high = m.jnt_range[k] if m.jnt_limited[k] else (-1, 1)
            coordinates[m.joint(k).name] = rng.uniform(max(low, -1.5), min(high, 1.5))
            rates[m.joint(k).name] = rng.normal()
    return coordinates, rates, rng.uniform(-0.4, 0.4, m.nu)


def by_mujoco(m, coordinates, rates, inputs):
    """Position and acceleration of the centre of mass of each body by name, m and m/s^2: J qdd + dJ/dt qd."""
    d = mujoco.MjData(m)
    for name, value in coordinates.items():
        d.joint(name).qpos[0], d.joint(name).qvel[0] = value, rates[name]
    d.ctrl[:] = inputs
    mujoco.mj_forward(m, d)
    found = {}
    for body in range(1, m.nbody):
        J, rate = np.zeros((3, m.nv)), np.zeros((3, m.nv))
        mujoco.mj_jac(m, d, J, None, d.xipos[body], body)
        mujoco.mj_jacDot(m, d, rate, None, d.xipos[body], body)
        found[m.body(body).name] = d.xipos[body].copy(), J @ d.qacc + rate @ d.qvel
    return found


def by_stiffmbs(path, coordinates, rates, inputs):
    """The same, of the scene that the file becomes."""
    names = load_robot(path).inputs
    changes = [(f"inputs.{name}", repr(float(u))) for name, u in zip(names, inputs, strict=True)]
    scene = load_robot(path, changes, coordinates=coordinates, rates=rates)
    run = stiffmbs.run(scene, duration=1e-6, output=1e-6, rtol=1e-10)
    bodies = [name for name in scene.bodies if f"{name}.x" in run]
    return {
        name: tuple(np.array([run[f"{name}.{a}{axis}"][0] for axis in "xyz"]) for a in ("", "a")) for name in bodies
    }


def worst_difference(path, m, seed):
    """The largest relative difference of accelerations of any body; positions are asserted to agree."""
    state = random_state(m, np.random.default_rng(seed))
    expected, found = by_mujoco(m, *state), by_stiffmbs(path, *state)
    shared = expected.keys() & found.keys()
    assert shared
    largest = max(np.abs(expected[name][1]).max() for name in shared)
    for name in shared:
        np.testing.assert_allclose(found[name][0], expected[name][0], atol=1e-9)
    return max(np.abs(found[name][1] - expected[name][1]).max() for name in shared) / largest
