"""Recorded steps and further output times do not change results."""

import numpy as np
import pytest

import stiffmbs
from tests.solve.test_stiff_reactions import four_bar
from tests.stress.families.stiffness.stiffness import bar_on_bushing


def same(first, second, every=1):
    """Return True if all channels of two runs are equal, those of the second at each `every`th time."""
    return all(np.array_equal(first[name], second[name][::every], equal_nan=True) for name in first)


@pytest.mark.parametrize("solver", ["radau", "bdf"])
@pytest.mark.parametrize(
    "scene", [lambda: bar_on_bushing(1e7), lambda: four_bar("rtol: 1e-4", 1e10, 7e8)], ids=["bar", "loop"]
)
def test_recording_changes_no_output(scene, solver):
    """Places within the steps of radau changed its outputs by 6e-9."""
    runs = [stiffmbs.run(scene(), solver=solver, duration=0.5, points=11, errors=errors) for errors in (False, True)]
    assert same(*runs) and runs[0].solver["steps"] == runs[1].solver["steps"]


def test_outputs_of_radau_do_not_depend_on_others():
    """A few outputs of a step were corrected one by one; the matrices for that stayed for the next steps."""
    few, many = (stiffmbs.run(four_bar("solver: radau, rtol: 1e-4", 1e10, 7e8), points=points) for points in (6, 501))
    for name in ("pin.fx", "bushing.fy", "a.angle"):
        assert np.allclose(few[name], many[name][::100], rtol=1e-8, atol=1e-8 * np.abs(many[name]).max())
