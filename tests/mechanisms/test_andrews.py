"""Andrews' squeezing mechanism against the published solution of the Test Set for IVP Solvers."""

import numpy as np
import pytest

import stiffmbs

ANGLES = (
    15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
    0.5244099658805304, 0.5347301163226948, 1.048080741042263,
)  # fmt: skip
RATES = (
    1139.920302151208, -1424.379294994111, 11.03291221937134, 19.29337464421385,
    0.5735699284790808, -19.29337464421385, 0.3231791658026955,
)  # fmt: skip


def relative(solution, channel):
    """beta, Theta, gamma, Phi, delta, Omega, epsilon from the bodies' absolute angles, or their rates, at the end."""
    k1, k2, k3, k4, k5, k6, k7 = (solution[f"K{k}.{channel}"][-1] for k in range(1, 8))
    return np.array([k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7])


@pytest.mark.parametrize(
    ("settings", "angle_error", "rate_error"),
    [
        ({"rtol": 1e-6}, 1e-4, 1e-2),
        ({"rtol": 1e-8}, 2e-6, 2e-4),
        ({"rtol": 1e-10}, 1e-8, 1e-6),
        ({"solver": "projected", "scheme": "dop853", "rtol": 1e-10}, 1e-9, 1e-7),
    ],
)
def test_angles_and_rates_at_the_end(examples, settings, angle_error, rate_error):
    solution = stiffmbs.run(stiffmbs.load_scene(examples / "andrews.yaml"), **settings)
    assert np.max(np.abs(relative(solution, "angle") / ANGLES - 1)) < angle_error
    difference = np.abs(relative(solution, "omega") - RATES) / np.maximum(np.abs(RATES), 1)
    assert np.max(difference) < rate_error
    assert solution.notes == ()


def test_requests_are_the_relative_angles(examples):
    solution = stiffmbs.run(stiffmbs.load_scene(examples / "andrews.yaml"), rtol=1e-6)
    found = [solution[name][-1] for name in ("theta", "phi", "omega")]
    np.testing.assert_allclose(found, relative(solution, "angle")[[1, 3, 5]], rtol=1e-14)
