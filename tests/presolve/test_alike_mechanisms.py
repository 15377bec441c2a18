"""Independent mechanisms are solved together where their steps are alike, and apart where one would chop up the others' motion."""

import json

import numpy as np
import pytest

import stiffmbs


def scene(pendulums, **others):
    """Pendulums by the angles that they begin at, with further bodies and forces."""
    content = {"gravity": [0, -9.81], "bodies": {}, "joints": {}, "forces": {}, "run": {"duration": 2, "points": 21}}
    for k, (angle, length) in enumerate(pendulums):
        at = [10 * k, 0]
        place = [at[0] + length * np.sin(angle), -length * np.cos(angle)]
        content["bodies"][f"p{k}"] = {
            "mass": 1, "inertia": 1e-3 * length**2, "position": place, "angle": angle,
        }  # fmt: skip
        content["joints"][f"h{k}"] = {
            "type": "revolute", "i": {"body": f"p{k}", "point": [0, length]}, "j": {"body": "ground", "point": at},
        }  # fmt: skip
    for section, items in others.items():
        content[section] |= items
    return stiffmbs.read_scene(json.dumps(content))


FAST = {
    "bodies": {"f": {"mass": 1e-2, "inertia": 1e-3, "position": [0, 2]}},
    "forces": {
        "s": {
            "type": "spring_damper",
            "i": "f",
            "j": {"body": "ground", "point": [0, 1]},
            "stiffness": 1e5,
            "free_length": 0.99,
        }
    },
}


def sets(scene, **settings):
    """The bodies that are solved together."""
    lines = [line for line in stiffmbs.check(scene, **settings).presolve if "solved separately" in line]
    return [each.strip() for each in lines[0].split(":")[1].split(";")] if lines else []


@pytest.mark.parametrize("solver", ["bdf", "projected", "auto"])
def test_pendulums_of_one_length_are_solved_together_at_whatever_angle(solver):
    assert sets(scene([(0.5 * np.pi, 1), (0.3, 1), (-1, 1)]), solver=solver) == []


@pytest.mark.parametrize("solver", ["bdf", "projected", "auto"])
def test_a_fast_oscillator_is_solved_apart_from_what_swings_slowly(solver):
    found = scene([(1, 1), (0.5, 1.1), (0.8, 0.9)], **FAST)
    assert sets(found, solver=solver) == ["p0, p1 and p2", "f"]


def test_what_bounces_is_solved_apart():
    ball = {"bodies": {"b": {"mass": 1, "inertia": 1, "position": [-5, 1]}}, "forces": {"c": {"type": "contact", "i": "b", "j": "ground", "stiffness": 1e5}}}  # fmt: skip
    assert sets(scene([(1, 1), (0.5, 1)], **ball)) == ["p0 and p1", "b"]


def test_a_long_run_is_worth_more_starts_than_a_short_one():
    different = scene([(1, 1), (1, 0.04)])
    assert sets(different, duration=0.05) == []
    assert sets(different, duration=50.0) == ["p0", "p1"]


def test_angles_are_those_of_pendulums_by_themselves():
    together = stiffmbs.run(scene([(1, 1), (0.5, 1.1), (0.8, 0.9)], **FAST), rtol=1e-9)
    for k, (angle, length) in enumerate([(1, 1), (0.5, 1.1), (0.8, 0.9)]):
        alone = stiffmbs.run(scene([(angle, length)]), rtol=1e-11)
        np.testing.assert_allclose(together[f"p{k}.angle"], alone["p0.angle"], atol=3e-7)


def test_a_study_has_the_numbers_of_its_runs_whether_they_are_solved_apart_or_together():
    given = scene([(1, 1)], **FAST)
    stiffness = [1e1, 1e5, 1e3]
    table = stiffmbs.sweep(given, {"forces.s.stiffness": stiffness}, outputs={"end": "final(p0.angle)"}, workers=1)
    for k, found in zip(stiffness, table["end"].values, strict=True):
        spring = {**FAST["forces"]["s"], "stiffness": k}
        assert found == stiffmbs.run(scene([(1, 1)], bodies=FAST["bodies"], forces={"s": spring}))["p0.angle"][-1]
