"""A disc that rolls by a user's own non-holonomic equations, against Routh's equations and the steady circle."""

import numpy as np
import pytest

import stiffmbs

from ..rolling import Disc
from ..spatial_channels import axes, vector
from ..spatial_closed_forms import steady_rolling, zxz

DISC = Disc(radius=0.3, mass=2.0, transverse=2 * 0.3**2 / 4, axial=2 * 0.3**2 / 2)
SOLVERS = pytest.mark.parametrize(
    "settings", [{"rtol": 1e-11}, {"solver": "projected", "scheme": "dop853", "rtol": 1e-11}], ids=["bdf", "dop853"]
)


@pytest.fixture(scope="module")
def rolled(examples):
    return lambda *changes, **settings: stiffmbs.run(
        stiffmbs.load_scene(examples / "rolling_disc.yaml", list(changes)), **settings
    )


@SOLVERS
def test_it_rolls_as_by_the_equations_of_routh(rolled, settings):
    """Five seconds: heading, tilt, spin and path."""
    solution = rolled(**settings)
    state = DISC.rolling(solution.time, 1.3, [0.2, 0.5, 6.0])
    np.testing.assert_allclose(axes(solution, "disc"), zxz(*state[:3]), atol=1e-8)
    np.testing.assert_allclose(vector(solution, "disc")[:, :2], state[6:].T, atol=1e-8)
    np.testing.assert_allclose(solution["disc.z"], 0.3 * np.sin(state[1]), atol=1e-8)
    assert solution.energy_drift() < 1e-8


@SOLVERS
def test_in_a_steady_circle_the_ground_bears_its_weight_and_pulls_it_inwards(rolled, settings):
    nutation, turning = 1.2, 2.0
    spin, path = steady_rolling(
        radius=0.3, mass=2.0, transverse=DISC.transverse, axial=DISC.axial, nutation=nutation, precession_rate=turning
    )
    start = {"lean": nutation, "falling": 0.0, "turning": turning * np.sin(nutation), "rolling": spin}
    changes = [(name, f"{float(value)!r} {'rad' if name == 'lean' else 'rad/s'}") for name, value in start.items()]
    solution = rolled(*changes, duration=2 * np.pi / turning, points=41, **settings)
    turned = axes(solution, "disc")
    np.testing.assert_allclose(turned[:, 2, 2], np.cos(nutation), atol=1e-9)
    np.testing.assert_allclose(vector(solution, "disc")[-1, :2], 0, atol=1e-8)
    force = vector(solution, "touch", "f") + vector(solution, "grip", "f")
    np.testing.assert_allclose(force[:, 2], 2 * 9.81, atol=1e-6)
    np.testing.assert_allclose(np.hypot(force[:, 0], force[:, 1]), 2 * turning**2 * path, atol=1e-6)


def test_it_has_three_equations_and_three_degrees_of_freedom(examples):
    found = stiffmbs.check(stiffmbs.load_scene(examples / "rolling_disc.yaml"))
    assert (found.degrees_of_freedom, found.equations, found.rank) == (3, 3, 3)
    assert found.sound
