"""Scenes with nothing in them but bodies."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Model


@pytest.mark.parametrize("solver", ["bdf", "projected", "auto"])
@pytest.mark.parametrize("gravity", [0.0, -9.81])
def test_a_body_alone_flies_on_its_parabola(solver, gravity):
    model = Model(gravity=(0, gravity))
    model.add("stone", Body(mass=2, inertia=3, velocity=(1, 2), omega=4))
    solution = stiffmbs.run(model, duration=1.0, points=11, solver=solver, step=1e-4)
    t = solution.time
    assert solution["stone.x"] == pytest.approx(t, abs=1e-9)
    assert solution["stone.y"] == pytest.approx(2 * t + gravity * t**2 / 2, abs=1e-3)
    assert solution["stone.angle"] == pytest.approx(4 * t, abs=1e-9)
    assert np.allclose(solution["energy.kinetic"][0], (2 * 5 + 3 * 16) / 2)
