"""Estimated costs of steps, by which `auto` chooses, beside measured ones."""

import pytest

from stiffmbs.analyses.job import prepare
from stiffmbs.solve.cost import of_explicit_step
from tests.bench.costs import SCENES


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "measured"),
    [("half_car", 3.4), ("governor", 16.4), ("chain_in_space_10", 33.5), ("reference_car_ideal", 307.0)],
)
def test_an_explicit_step_costs_what_it_was_measured_to_beside_one_of_an_axle(name, measured):
    """Microseconds on one machine, 11.2 on the axle, which has no constraints: elimination counts by its multiplications."""
    steps = [
        of_explicit_step(prepare(SCENES[scene](), solver="projected", scheme="dop853").dynamics)
        for scene in (name, "axle")
    ]
    assert steps[0] / steps[1] == pytest.approx(measured / 11.2, rel=0.3)
