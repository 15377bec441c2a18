"""Runs whose tolerance follows from the accuracy asked for."""

from textwrap import dedent

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.model.accuracy import from_option, wanted
from tests.error_estimate.test_against_truth import PENDULUM, pendulum

from ..conftest import EXAMPLES

SCENE = PENDULUM.format(duration=8)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("asked", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("solver", ["bdf", "radau", "auto"])
def test_positions_are_as_accurate_as_asked(asked, solver):
    scene = stiffmbs.read_scene(SCENE)
    found = stiffmbs.run(scene, solver=solver, accuracy={"positions": f"{asked} m", "forces": "1 %"})
    angle, _ = pendulum(found.time)
    assert "reached positions" in found.estimate.sentence and not any("accuracy" in note for note in found.notes)
    assert np.abs(found["bob.x"] - np.cos(angle)).max() < asked


@pytest.mark.long
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
    assert "reached positions" in found.estimate.sentence and found.errors["slider.x"].over_time < 1e-15
    exact = stiffmbs.run(EXAMPLES / "crank_slider.yaml", solver="kinematic", points=len(found.time))
    assert np.abs(found["slider.x"] - exact["slider.x"]).max() < 1e-9


TUMBLING = "dimensions: 3\nbodies: {r: {mass: 1, inertia: [0.01, 0.02, 0.03], omega: [0, 4, 0.1]}}\nrun: {duration: 1}"
DOUBLE = """
gravity: [0, -9.81]
bodies: {a: {mass: 1, inertia: 0.1, position: [1, 0]}, b: {mass: 1, inertia: 0.1, position: [3, 0]}}
joints:
  p: {type: revolute, i: {body: a, point: [-1, 0]}, j: ground}
  q: {type: revolute, i: {body: b, point: [-1, 0]}, j: {body: a, point: [1, 0]}}
"""


@pytest.mark.parametrize("asked", ["1 %", "1 N"])
def test_a_scene_without_forces_has_any_accuracy_of_these(asked):
    """Their error was 'nan %', and the note said that it was not reached."""
    found = stiffmbs.run(stiffmbs.read_scene(TUMBLING), accuracy={"forces": asked, "velocities": "1 %"})
    assert f"there are no forces to judge (asked: {asked})" in found.estimate.sentence
    assert "reached velocities" in found.estimate.sentence and not any("accuracy" in note for note in found.notes)


@pytest.mark.parametrize("scheme, reached", [("rk4", True), ("euler_cromer", False)])
def test_fixed_steps_are_judged_and_not_repeated(scheme, reached):
    """Three runs said 'nan', with a note on an rtol that nobody set."""
    how = {"solver": "projected", "scheme": scheme, "step": "1 ms"}
    found = stiffmbs.run(stiffmbs.read_scene(DOUBLE), accuracy={"positions": "0.1 mm"}, duration=2, **how)
    sentences = [found.estimate.sentence] if reached else [note for note in found.notes if "accuracy" in note]
    assert ["with steps of at most 0.001 s" in each for each in sentences] == [True]
    assert not any("rtol" in note for note in found.notes)


@pytest.mark.long
def test_a_lost_solution_has_unknown_errors():
    asked = {"positions": "10 %"}
    found = stiffmbs.run(stiffmbs.read_scene(DOUBLE), solver="bdf", duration=30, accuracy=asked)
    assert found.estimate.status == "lost"
    (note,) = (note for note in found.notes if note.kind == "accuracy-not-reached")
    assert "the errors of positions are unknown (asked: 10 %)" in note


def test_stages_say_what_each_has_reached():
    """Only the estimate over all stages was in the summary."""
    stages = """
        stages:
        - {analysis: static}
        - {run: {duration: 1, accuracy: {positions: 0.1 mm}}}
        - {run: {duration: 1}}
        - {run: {duration: 1, accuracy: {positions: 1 um}}}
    """
    scene = "gravity: [0, -9.81]\n" + SCENE[SCENE.index("bodies:") : SCENE.index("run:")] + dedent(stages)
    sentence = stiffmbs.run(stiffmbs.read_scene(scene)).estimate.sentence
    assert "run 2: reached positions" in sentence and "run 4: reached positions" in sentence
    assert sentence.count("reached") == 2


@pytest.mark.long
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
