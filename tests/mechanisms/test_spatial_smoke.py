"""A pendulum in space, first of all: it swings as the planar one."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import spatial


def planar_pendulum():
    model = stiffmbs.Model("bar", gravity=(0, -9.81))
    bar = model.add("bar", stiffmbs.Body(mass=1, inertia=0.1, position=(2, 0)))
    model.add("hinge", stiffmbs.Revolute(i=bar.at(-2, 0), j="ground"))
    return model


def spatial_pendulum(**inertia):
    model = spatial.Model("bar", gravity=(0, -9.81, 0))
    body = {"mass": 1, "inertia": (0.04, 0.1, 0.1), "position": (2, 0, 0)} | inertia
    model.add("bar", spatial.Body(**body))
    model.add("hinge", spatial.Revolute(i=spatial.Marker(body="bar", point=(-2, 0, 0)), j="ground"))
    return model


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_pendulum_swings_in_space_as_in_the_plane(solver):
    settings = {"duration": 3.0, "rtol": 1e-9, "solver": solver, "output": 0.1}
    if solver == "projected":
        settings["scheme"] = "dop853"
    plane, space = (stiffmbs.run(model, **settings) for model in (planar_pendulum(), spatial_pendulum()))
    for channel in ("bar.x", "bar.y", "bar.vx", "hinge.fx", "hinge.fy", "energy.kinetic"):
        assert np.allclose(plane[channel], space[channel], rtol=0, atol=2e-6), channel
    p = np.stack([space[f"bar.q{k}"] for k in range(4)])
    assert np.allclose(p[0], np.cos(plane["bar.angle"] / 2), atol=1e-7)
    assert np.abs(np.sum(p**2, axis=0) - 1).max() < 1e-14
    for channel in ("bar.z", "bar.wx", "hinge.fz", "hinge.tx", "hinge.ty", "hinge.tz"):
        assert np.abs(space[channel]).max() < 1e-12, channel
    assert np.allclose(space["bar.wz"], plane["bar.omega"], atol=1e-6)
