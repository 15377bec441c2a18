"""Settings of runs that scenes have wrong."""

import pytest

import stiffmbs
from stiffmbs.errors import InputError

SCENE = "bodies: {b: {mass: 1, inertia: 1}}\n"


@pytest.mark.parametrize(
    ("start", "words"),
    [
        (
            "equilibrium",
            "found 'equilibrium', expected a time in s; 'start: equilibrium' belongs to the scene, outside 'run'",
        ),
        ("settled", "'start: settled' belongs to the scene"),
        ("{velocity: [1, 0]}", "found a mapping, expected a time in s; 'start: {...}' belongs to the scene"),
    ],
)
def test_a_pose_at_the_start_belongs_to_the_scene(start, words):
    with pytest.raises(InputError) as found:
        stiffmbs.read_scene(f"{SCENE}run: {{start: {start}}}\n")
    assert "line 2, run.start: " in str(found.value)
    assert words in str(found.value)


def test_a_parameter_with_the_name_of_a_pose_is_a_time():
    scene = stiffmbs.read_scene(f"{SCENE}parameters: {{settled: 2 s}}\nrun: {{start: settled}}\n")
    assert scene.run.start == 2.0
