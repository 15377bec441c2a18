"""Runs that are looked at while they go on."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_what_is_handed_out_is_the_beginning_of_the_run(examples, solver, monkeypatch):
    monkeypatch.setattr("stiffmbs.studies.follow.SHARE", 0.0)  # whatever the clock says
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    settings = {"duration": 0.5, "rtol": 1e-10, "solver": solver}
    *parts, last = stiffmbs.follow(scene, every=0.0, **settings)
    whole = stiffmbs.run(scene, **settings)
    assert len(parts) == 49
    assert (last.success, last.message) == (True, whole.message)
    assert last.units == whole.units
    for channel in ("cart.x", "bar.angle", "rail.fy"):
        np.testing.assert_allclose(last[channel], whole[channel], atol=1e-6 if channel == "rail.fy" else 1e-8)
    for part in parts:
        assert not part.success
        np.testing.assert_array_equal(part["cart.x"], last["cart.x"][: len(part.t)])


def test_a_run_that_stops_keeps_what_was_solved():
    model = stiffmbs.Model(gravity=(0, 0))
    bob = model.add("bob", stiffmbs.Body(mass=1, inertia=1))
    model.add("push", stiffmbs.AppliedForce(i=bob, force=["1 N / (0.5 - t / 1 s)", 0]))
    *_, last = stiffmbs.follow(model, duration=1.0, points=101)
    assert not last.success
    assert 0.4 < last.t[-1] <= 0.5


def test_a_wrong_time_is_told_before_anything_is_solved(examples):
    with pytest.raises(InputError, match="follow: found every = -1"):
        stiffmbs.follow(examples / "cart_pendulum.yaml", every=-1)
