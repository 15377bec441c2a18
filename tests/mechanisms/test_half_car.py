"""The stiff half car over a bump: a converged reference to ten digits, for soft and stiff bushings."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Bushing, Marker, Model, SpringDamper

REFERENCE = {
    ("1e5", "0.02"): (0.630036205, 0.6000148835, 0.39639608, 3087.981603),
    ("1e7", "0.02"): (0.630518269, 0.6000148713, 0.39794994, 3088.061444),
}
"""Chassis y largest (on the output grid) and at 5 s, front wheel centre largest, vertical force of the front pair."""
ROAD = "min(max(15*t - {behind}, 0), 2)"
TYRE = (
    "{load} + 200e3*(0.05*(1 - cos(pi*{s})) - dy({body}.wheel) + 0.30)"
    " + 500*(0.05*pi*15*sin(pi*{s}) - vy({body}.wheel))"
)


@pytest.fixture(scope="module", params=REFERENCE, ids="-".join)
def case(request, examples):
    k_b, zeta = request.param
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", k_b), ("zeta", zeta)])
    return stiffmbs.run(scene, rtol=1e-10), REFERENCE[request.param]


def test_motion_and_force_against_the_converged_ones(case):
    solution, (highest, at_end, wheel_highest, force) = case
    angle = solution["front.angle"]
    wheel = solution["front.y"] - 0.10 * np.sin(angle) - 0.01 * np.cos(angle)
    assert solution["chassis.y"].max() == pytest.approx(highest, abs=1.5e-9)
    assert solution["chassis.y"][-1] == pytest.approx(at_end, abs=1.5e-9)
    assert wheel.max() == pytest.approx(wheel_highest, abs=1.5e-8)
    assert solution["front_bushing.fy"][-1] == pytest.approx(force, abs=3e-5)


def test_the_same_car_built_in_python(examples):
    scene = stiffmbs.load_scene(examples / "half_car.yaml")
    settings = {"duration": 0.4, "output": 5e-3, "rtol": 1e-9}
    expected = stiffmbs.run(scene, **settings)
    found = stiffmbs.run(half_car(1e7, 0.02), **settings)
    for name in ("chassis.y", "front.y", "rear.angle"):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-10)


def half_car(k_b, zeta):
    c_b = zeta * np.sqrt(2 * k_b * 40)
    model = Model("Half car", gravity=(0, -9.81))
    model.add("chassis", Body(mass=1200, inertia=1800, position=(0, 0.60)))
    wheels = {
        "front": (1.45, 6307.466667, 3088.333333, 9003.4, 0),
        "rear": (-1.25, 6249.333333, 3059.266667, 8916.2, 2.7),
    }
    for name, (x, load, preload, spring, behind) in wheels.items():
        arm = model.add(
            name, Body(mass=40, inertia=1.5, position=(x, 0.31), markers={"wheel": {"point": (-0.1, -0.01)}})
        )
        model.add(
            f"{name}_pair",
            Bushing(
                i=arm.at(0.35, 0.04), j=Marker(body="chassis", point=(x + 0.35, -0.25)), axes="ground",
                stiffness=(2 * k_b, 2 * k_b, 1000), damping=(2 * c_b, 2 * c_b, 10), preload=(0, preload, 0),
            ),
        )  # fmt: skip
        model.add(
            f"{name}_spring",
            SpringDamper(
                i=arm.at(0.05, 0.04), j=Marker(body="chassis", point=(x + 0.05, 0.20)),
                stiffness=60e3, damping=5e3, free_length=0.45, preload=-spring,
            ),
        )  # fmt: skip
        s = ROAD.format(behind=behind)
        tyre = TYRE.format(load=load, s=s, body=name)
        model.add(f"{name}_tyre", AppliedForce(i=f"{name}.wheel", force=(0, tyre)))
    return model
