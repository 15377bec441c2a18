"""Axes and quaternions of markers, against rotation matrices."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from stiffmbs.results.marker_motion import BodyFrame, MarkerFrame, times, turned


def marker(body, own):
    w_last = body.as_quat().T
    frame = BodyFrame(lambda labels: tuple(w_last[[3, 0, 1, 2]]), False, np)
    x, y, z, w = own.as_quat()
    return MarkerFrame(frame, (0.0, 0.0, 0.0), (w, x, y, z))


@pytest.mark.parametrize("k", range(3))
def test_axes_of_random_markers(k):
    (one, other), (a, b) = ([Rotation.random(n, random_state=s) for s in (k, k + 3)] for n in (50, None))
    i, j = marker(one, a), marker(other, b)
    expected = ((other * b).inv() * (one * a)).as_matrix()
    np.testing.assert_allclose(np.stack(turned(j.axes, i.axes[k]), axis=1), expected[:, :, k], atol=1e-12)
    w, x, y, z = j.quaternion
    relative = np.stack(times((w, -x, -y, -z), i.quaternion), axis=1)
    np.testing.assert_allclose(Rotation.from_quat(relative[:, [1, 2, 3, 0]]).as_matrix(), expected, atol=1e-12)
