"""Explicit steps beside rest: rounding must not grow to the tolerance before the error estimate sees that steps are too long."""

import json

import numpy as np
import pytest

import stiffmbs

STIFFNESS, DAMPING, MASS = 1e8, 0.05, 10.0
"""N/m, damping ratio, kg."""


def at_rest(**changes):
    """A body that rests on a stiff spring, beside one that swings on a soft one."""
    law = f"-{STIFFNESS}*seat.y - {2 * DAMPING * np.sqrt(STIFFNESS * MASS)}*seat.vy"
    given = {
        "gravity": [0, -9.81],
        "bodies": {
            "seat": {"mass": MASS, "inertia": 1, "position": [0, -MASS * 9.81 / STIFFNESS]},
            "swinging": {"mass": 1, "inertia": 1, "position": [0.1, 1]},
        },
        "forces": {
            "stiff": {"type": "force", "i": "seat", "force": [0, law]},
            "soft": {"type": "force", "i": "swinging", "force": ["-40*swinging.x", 9.81]},
        },
    }
    return stiffmbs.read_scene(json.dumps(given | changes))


@pytest.mark.parametrize("rtol", [1e-2, 1e-4])
def test_a_stiff_spring_at_rest_stays_there(rtol):
    """Its force was off by as much as the weight, for good."""
    solution = stiffmbs.run(at_rest(), solver="projected", scheme="dop853", rtol=rtol, duration=4.0, points=401)
    after = solution["seat.ay"][200:]
    assert np.max(np.abs(after)) < 1e-4 * 9.81
