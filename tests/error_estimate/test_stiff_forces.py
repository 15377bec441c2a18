"""Estimated errors of reactions next to very stiff bushings in a loop, against runs of radau with a much smaller tolerance."""

from functools import partial

import numpy as np
import pytest

import stiffmbs
from tests.error_estimate.test_against_truth import ratio
from tests.solve.test_stiff_reactions import REACTIONS, four_bar
from tests.stress.families.stiffness.stiffness import bar_on_bushing

WELL_DAMPED = (1e12, 7e9)
LIGHTLY_DAMPED = (1e13, None)


@pytest.mark.parametrize("solver", ["radau", "bdf"])
@pytest.mark.parametrize("bushing", [WELL_DAMPED, LIGHTLY_DAMPED], ids=["1e12", "1e13"])
def test_errors_of_poses_do_not_stretch_stiff_bushings(solver, bushing):
    """Bars of forces were 1000 to 3e8 times the errors, as poses without their errors were off by 1e-10 m; or all was lost."""
    found = stiffmbs.run(four_bar(f"solver: {solver}, rtol: 1e-4, errors: true", *bushing))
    truth = stiffmbs.run(four_bar("solver: radau, rtol: 1e-9, errors: false", *bushing))
    assert found.estimate.status == "estimated"
    assert 0.8 < ratio(found, "a.angle", truth["a.angle"]) < 1.2
    for name in REACTIONS:
        assert 1 / 4 < ratio(found, name, truth[name]) < 4


@pytest.mark.parametrize("stiffness", [1e10, 1e12])
def test_motions_beside_a_stiff_bushing_have_the_errors_of_rigid_ones(stiffness):
    """Linearised by differences, a stretched bushing turned: poses had bars 20 to 300 times their errors."""
    found = stiffmbs.run(four_bar("solver: radau, rtol: 1e-6, errors: true", stiffness))
    truth = stiffmbs.run(four_bar("solver: radau, rtol: 1e-10, errors: false", stiffness))
    assert 0.7 < ratio(found, "a.angle", truth["a.angle"]) < 1.4
    assert max(found.errors[name].over_time / np.abs(truth[name]).max() for name in REACTIONS) < 1e-3


@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
@pytest.mark.parametrize("scene", [bar_on_bushing, partial(four_bar, "")], ids=["bar", "loop"])
def test_defects_of_radau_beside_stiff_bushings(scene, rtol):
    """At the points of the method itself the curve of a step has small defects: bars were 0.04 to 0.6 of the errors."""
    found = stiffmbs.run(scene(1e8), solver="radau", rtol=rtol, errors=True)
    truth = stiffmbs.run(scene(1e8), solver="radau", rtol=1e-11, errors=False)
    names = (name for name in found if name.endswith((".angle", ".omega")) or name in (*REACTIONS, "bearing.fx"))
    for name in names:
        assert 0.4 < ratio(found, name, truth[name]) < 2.5, name


def test_every_block_of_a_run_may_be_taken_step_by_step():
    """Vibrations of all time scales of the steps: no row had a slope of its error, and closing none of them failed."""
    scene = stiffmbs.read_scene("""
        dimensions: 3
        bodies: {a: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
        forces: {s: {type: force, i: a, force: [-1e2*a.x, -1e5*a.y, -1e8*a.z]}}
        run: {duration: 2, solver: bdf, rtol: 1e-2, errors: true}
    """)
    found = stiffmbs.run(scene)
    assert 0.5 < ratio(found, "a.x", np.cos(10 * found.time)) < 2
