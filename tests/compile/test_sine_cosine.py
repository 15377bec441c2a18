"""Sines and cosines of four angles at once."""

import numpy as np
import pytest

from stiffmbs.compile.machine.routines import Routine

FOUR = Routine("stiffmbs.compile.machine.native.evaluate", "share_four", "int64(float64*, int64*, float64*)")
BODIES = np.array([0, 3, 6, 9])


def shared(angles):
    """Whether they were shared; cosines and sines."""
    q, turn = np.zeros(12), np.zeros(12)
    q[2::3] = angles
    done = FOUR.short_call(q.ctypes.data, BODIES.ctypes.data, turn.ctypes.data)
    return done, turn[0::3], turn[1::3]


@pytest.mark.parametrize("largest", [1e-6, 1.0, 30.0, 9e4])
def test_within_a_unit_of_the_last_place(largest):
    for angles in np.random.default_rng(1).uniform(-largest, largest, (500, 4)):
        done, cosine, sine = shared(angles)
        exact = angles.astype(np.longdouble)
        assert done
        for found, expected in ((cosine, np.cos(exact)), (sine, np.sin(exact))):
            assert np.all(np.abs(found - expected) <= np.spacing(np.abs(expected.astype(float))))


def test_at_quarters_of_a_turn_what_rounding_leaves_of_the_angle_counts():
    angles = np.array([np.pi / 2, np.pi, -1.5 * np.pi, 1000 * np.pi])
    _, cosine, sine = shared(angles)
    assert np.max(np.abs(np.append(cosine - np.cos(angles), sine - np.sin(angles)))) < 1e-30


@pytest.mark.parametrize("angle", [1.1e5, -np.inf])
def test_far_angles_are_left_to_the_library(angle):
    assert not shared([0.1, angle, 0.2, 0.3])[0]


def test_an_angle_that_is_no_number_spoils_no_other():
    done, cosine, sine = shared([0.1, np.nan, 0.2, 0.3])
    assert not done or (np.isnan([cosine[1], sine[1]]).all() and np.isfinite(cosine[[0, 2, 3]]).all())
