"""Steps that stability holds back: the fastest rate bounds them, so that they do not go to and fro about the limit."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare

DOP853 = {"solver": "projected", "scheme": "dop853"}


@pytest.mark.parametrize("stiffness", ["1e6", "1e7"])
def test_few_steps_are_rejected_on_stiff_bushings(examples, stiffness):
    """Before, one in eight; the end is that of a run at a far tighter tolerance."""
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", stiffness)])
    found, exact = (prepare(scene, rtol=rtol, **DOP853).integrate() for rtol in (1e-5, 1e-10))
    assert found.statistics["rejected"] < 0.04 * found.statistics["steps"]
    assert np.max(np.abs(found.q[-1] - exact.q[-1])) < 1e-6
