"""Events that come together are one, and one that the projection onto the constraints would find again is not counted twice."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Marker, Model, Revolute, SpringDamper


def abreast(apart):
    """Three sleds side by side, which run into springs at the same place but for a part of the way."""
    model = Model()
    for k in range(3):
        model.add(f"sled{k}", Body(mass=1, inertia=1, position=(0.0, k), velocity=(1, 0)))
        spring = f"-1000*max(sled{k}.x - 0.5*(1 + {k * apart}), 0)"
        model.add(f"stop{k}", AppliedForce(i=f"sled{k}", force=(spring, 0)))
        if k:
            model.add(f"spring{k}", SpringDamper(i=f"sled{k - 1}", j=f"sled{k}", stiffness=1e-6, free_length=1.0))
    return model


@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize(("apart", "events"), [(1e-13, 1), (1e-3, 3)])
def test_events_at_the_same_instant_are_one(rtol, apart, events):
    solution = stiffmbs.run(abreast(apart), solver="bdf", rtol=rtol, duration=0.55, points=12)
    assert solution.solver["events"] == events
    rate = np.sqrt(1000)
    for k in range(3):
        met = 0.5 * (1 + k * apart)
        exact = met + np.sin(rate * (0.55 - met)) / rate
        assert solution[f"sled{k}.x"][-1] == pytest.approx(exact, abs=rtol)


def bar_onto_a_spring():
    """Projected onto the pin, the bar is above the spring again where the step's polynomial has met it."""
    model = Model(gravity=(0, -9.81))
    model.add("bar", Body(mass=1, inertia=0.1, position=(0.5, 0)))
    model.add("hinge", Revolute(i=Marker(body="bar", point=(-0.5, 0)), j="ground"))
    model.add("stop", AppliedForce(i="bar", force=(0, "2000*max(-0.3 - bar.y, 0)")))
    return model


@pytest.mark.long
def test_an_event_is_not_met_again_behind_the_projection():
    """The bar meets the spring and leaves it, two events; at these ten tolerances there were 30 in all."""
    tolerances = np.geomspace(1e-2, 1e-7, 41)[12:22]
    runs = [stiffmbs.run(bar_onto_a_spring(), solver="bdf", rtol=rtol, duration=1.0, points=12) for rtol in tolerances]
    assert all(2 <= run.solver["events"] <= 4 for run in runs)
    assert sum(run.solver["events"] for run in runs) <= 24
    exact = stiffmbs.run(bar_onto_a_spring(), solver="bdf", rtol=1e-10, duration=1.0, points=12)
    for rtol, run in zip(tolerances, runs, strict=True):
        assert run["bar.y"][-1] == pytest.approx(exact["bar.y"][-1], abs=10 * rtol)
