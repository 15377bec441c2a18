"""Estimated costs of steps, by which `auto` chooses, beside measured ones."""

import pytest

from stiffmbs.analyses.job import prepare
from stiffmbs.solve.cost import of_explicit_step
from stiffmbs.solve.ida.choice import driven
from stiffmbs.solve.radau.radau import driver, of_radau
from tests.bench.costs import SCENES


@pytest.mark.sampled(3)
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


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "explicit_steps", "residuals", "matrices"),
    [("half_car", 820, 3140, 209), ("axle", 866, 1367, 91), ("reference_car_bushings", 752, 2669, 169)],
)
def test_residuals_and_matrices_of_radau_cost_what_they_were_measured_to_beside_explicit_steps(
    name, explicit_steps, residuals, matrices
):
    """Explicit steps of the same time as runs at rtol 1e-7 with bushings of 1e7 N/m; the car's cost was half of it."""
    job = prepare(SCENES[name](), solver="radau")
    dynamics = (job.subsystems or [job])[0].dynamics
    cost = of_radau(dynamics, 1e-3 * driven(dynamics, job.settings, **driver()).cost)
    steps = cost.work(residuals, matrices) / of_explicit_step(dynamics)
    assert steps == pytest.approx(explicit_steps, rel=0.3)
