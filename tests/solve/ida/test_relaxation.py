"""The relaxed formulation stays within the tolerance where bodies or their moments of inertia are light."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Model, Prismatic, Revolute


@pytest.mark.parametrize("inertia", [1e-2, 1e-4, 1e-6, 1e-9])
@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
def test_a_point_mass_on_a_rod_keeps_its_energy(inertia, rtol):
    model = Model(gravity=(0, -9.81))
    bob = model.add("bob", Body(mass=1, inertia=inertia, position=(0.5, 0)))
    model.add("pin", Revolute(i=bob.at(-0.5, 0), j="ground"))
    solution = stiffmbs.run(model, duration=3.0, rtol=rtol)
    assert solution.energy_drift() < 200 * rtol * 9.81 * 0.5
    assert np.max(np.abs(solution["bob.angle"])) == pytest.approx(np.pi, abs=1e3 * rtol)


@pytest.mark.parametrize("part", [1, 1e-3, 1e-6, 1e-9])
def test_a_light_rod_between_heavy_bodies_keeps_energy(part):
    model = Model()
    crank = model.add("crank", Body(mass=2, inertia=0.02, omega=10))
    rods = [
        model.add(name, Body(mass=part, inertia=part * 0.01, position=(x, 0)))
        for name, x in (("first", 0.15), ("second", 0.35))
    ]
    model.add("piston", Body(mass=1, inertia=0.01, position=(0.5, 0)))
    model.add("bearing", Revolute(i="crank", j="ground"))
    model.add("crank_pin", Revolute(i=crank.at(0.1, 0), j=rods[0].at(-0.05, 0)))
    model.add("weld", stiffmbs.Fixed(i=rods[0].at(0.05, 0), j=rods[1].at(-0.15, 0)))
    model.add("piston_pin", Revolute(i=rods[1].at(0.15, 0), j="piston"))
    model.add("guide", Prismatic(i="piston", j="ground"))
    solution = stiffmbs.run(model, duration=1.0, rtol=1e-6)
    assert solution.energy_drift() < 1e-4 * solution["energy.kinetic"][0]
