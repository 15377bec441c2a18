"""What a run stopped for is named."""

import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Drive, Model, PointOnLine, Prismatic, Revolute


def sled(**force):
    model = Model()
    model.add("sled", Body(mass=2, inertia=1))
    model.add("other", Body(mass=1, inertia=1, position=(0, 1)))
    model.add("track", Prismatic(i="sled", j="ground"))
    model.add("tide", AppliedForce(i="other", force=("sin(t)", 0)))
    model.add("pull", AppliedForce(i="sled", **force))
    return model


@pytest.mark.parametrize("solver", ["bdf", "projected"])
@pytest.mark.parametrize(
    ("force", "clause"),
    [
        ("sqrt(1 - t)", "'pull' has no finite value"),
        ("1/(1 - t)^2", "'pull'"),
        ("sqrt(0.01 - sled.x) + 1", "'pull' has no finite value"),
    ],
)
def test_a_force_without_a_value(solver, force, clause):
    solution = stiffmbs.run(sled(force=(force, 0)), duration=2.0, points=41, solver=solver)
    assert solution.outcome.name == "STOPPED"
    assert "stopped at t = " in solution.message
    assert clause in solution.message


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_motor_that_asks_for_more_than_a_rod_allows(solver):
    model = Model()
    crank = model.add("crank", Body(mass=1, inertia=0.1, position=(0.25, 0)))
    rod = model.add("rod", Body(mass=1, inertia=0.1, position=(0.7, 0)))
    model.add("bearing", Revolute(i=crank.at(-0.25, 0), j="ground"))
    model.add("pin", Revolute(i=rod.at(-0.2, 0), j=crank.at(0.25, 0)))
    model.add("foot", PointOnLine(i=rod.at(0.2, 0), j="ground"))
    model.add("motor", Drive(joint="bearing", position="2*t"))
    solution = stiffmbs.run(model, duration=10.0, points=101, solver=solver)
    assert solution.outcome.name == "STOPPED"
    joints = ("bearing", "pin", "foot", "motor")
    assert any(
        f"'{j}' causes the largest acceleration" in solution.message or f"joint '{j}' (equation" in solution.message
        for j in joints
    )
