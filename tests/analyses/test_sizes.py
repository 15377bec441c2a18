"""Mechanisms of any size: lengths scaled by a factor scale time by its root, and angles stay."""

import pytest

import stiffmbs
from stiffmbs import Body, Model, Revolute

HOW = [{"solver": "bdf"}, {"solver": "projected", "scheme": "dopri5"}, {"solver": "projected", "scheme": "dop853"}]


def double_pendulum(length, how):
    model = Model(gravity=(0, -9.81))
    inner = model.add("inner", Body(mass=1, inertia=length**2 / 12, position=(length / 2, 0)))
    outer = model.add("outer", Body(mass=1, inertia=length**2 / 12, position=(3 * length / 2, 0)))
    model.add("shoulder", Revolute(i=inner.at(-length / 2, 0), j="ground"))
    model.add("elbow", Revolute(i=outer.at(-length / 2, 0), j=inner.at(length / 2, 0)))
    return stiffmbs.run(model, duration=2 * length**0.5, points=51, rtol=1e-8, **how)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("how", HOW, ids=str)
@pytest.mark.parametrize("length", [1e-6, 1e-3, 1e4, 1e6])
def test_a_double_pendulum_of_any_size_swings_alike(length, how):
    solution, reference = double_pendulum(length, how), double_pendulum(1.0, how)
    assert len(solution.time) == 51
    for body in ("inner", "outer"):
        assert solution[f"{body}.angle"] == pytest.approx(reference[f"{body}.angle"], abs=1e-5)
