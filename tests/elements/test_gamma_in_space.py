"""The second rates of constraints in space: each vector's own by a name, not its derivative by each turn of each body."""

import pytest

from stiffmbs.analyses.warm import usual_elements
from stiffmbs.compile.kind import sorted_out
from stiffmbs.compile.symbolic.derive import derive
from stiffmbs.compile.symbolic.generate import kernel_source

MOST = {"revolute_0": 240, "prismatic_0": 410, "cylindrical_0": 350, "distance_0": 175}


def products(name):
    """Multiplications and divisions in the kernel of accelerations."""
    scene = usual_elements(3).data()
    kind, _ = sorted_out(name, scene.joints[name].at_initial_pose(scene), scene)
    lines = kernel_source("acceleration", derive(kind), "kernel").partition("def kernel")[2].splitlines()
    return sum(line.partition(" = ")[2].count("*") for line in lines if "index[" not in line)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("name", MOST)
def test_accelerations_take_few_products(name):
    assert products(name) <= MOST[name]
