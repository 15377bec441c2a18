"""Runs whose tolerance follows from the accuracy asked for."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.model.accuracy import from_option, wanted
from tests.error_estimate.test_against_truth import PENDULUM, pendulum

from ..conftest import EXAMPLES

SCENE = PENDULUM.format(duration=8)


@pytest.mark.parametrize("asked", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("solver", ["bdf", "radau", "auto"])
def test_positions_are_as_accurate_as_asked(asked, solver):
    scene = stiffmbs.read_scene(SCENE)
    found = stiffmbs.run(scene, solver=solver, accuracy={"positions": f"{asked} m", "forces": "1 %"})
    angle, _ = pendulum(found.time)
    assert "reached positions" in found.estimate.sentence and not any("accuracy" in note for note in found.notes)
    assert np.abs(found["bob.x"] - np.cos(angle)).max() < asked


def test_an_accuracy_that_is_not_reached_is_reported():
    found = stiffmbs.run(stiffmbs.read_scene(SCENE), solver="bdf", accuracy={"positions": "1e-16 m"})
    assert any("was not reached: reached positions" in note for note in found.notes)


def test_motions_of_drives_have_any_accuracy():
    """The kinematic solver has no tolerance and no estimate of errors: an assertion failed."""
    found = stiffmbs.run(EXAMPLES / "four_bar.yaml", accuracy={"forces": "1 %"})
    (note,) = (note for note in found.notes if note.kind.startswith("accuracy"))
    assert note.kind == "accuracy-exact" and not any("no effect" in note for note in found.notes)


def test_an_interrupted_run_has_no_accuracy():
    """An assertion on its estimate failed."""

    def interrupt(t):
        raise KeyboardInterrupt

    found = stiffmbs.run(stiffmbs.read_scene(SCENE), watch=interrupt, accuracy={"positions": "1 mm"})
    assert found.estimate is None and not any("accuracy" in note for note in found.notes)


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_an_error_of_zero_is_any_accuracy(solver):
    """The next tolerance was computed, by a division by the error: here a drive prescribes the motion."""
    found = stiffmbs.run(EXAMPLES / "crank_slider.yaml", solver=solver, accuracy={"positions": "1 um"})
    assert "reached positions 0 m" in found.estimate.sentence
    exact = stiffmbs.run(EXAMPLES / "crank_slider.yaml", solver="kinematic", points=len(found.time))
    assert np.abs(found["slider.x"] - exact["slider.x"]).max() < 1e-9


def test_a_verified_run_has_the_accuracy_asked_for():
    """The tolerance was that of the settings, whatever the accuracy."""
    asked = {"positions": "1e-6 m"}
    found = stiffmbs.verify(stiffmbs.read_scene(SCENE), solver="bdf", accuracy=asked)
    alone = stiffmbs.run(stiffmbs.read_scene(SCENE), solver="bdf", accuracy=asked)
    assert found.solver["steps"] == alone.solver["steps"] and found.verification
    assert "reached positions" in found.estimate.sentence
    assert np.abs(found["bob.x"] - np.cos(pendulum(found.time)[0])).max() < found.errors["bob.x"].over_time < 1e-5


def test_accuracies_have_units_or_are_relative():
    forces, positions = wanted({"forces": "1 %", "positions": "0.1 mm"})
    assert (forces.error, forces.relative) == (0.01, True)
    assert positions.error == pytest.approx(1e-4) and not positions.relative
    assert from_option("forces=1%, positions=0.1mm") == {"forces": "1%", "positions": "0.1mm"}


@pytest.mark.parametrize(
    "asked, message",
    [
        ({"force": "1 %"}, "did you mean 'forces'"),
        ({"forces": "1 mm"}, "expected a force"),
        ({"forces": "0 %"}, "greater than zero"),
    ],
)
def test_others_are_refused(asked, message):
    with pytest.raises(InputError, match=message):
        stiffmbs.run(stiffmbs.read_scene(SCENE), accuracy=asked)
