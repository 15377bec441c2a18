"""Independent mechanisms are solved separately, as the steps and events of one would chop up the motion of the others."""

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
def test_each_mechanism_is_solved_by_itself(solver):
    ball = {"bodies": {"b": {"mass": 1, "inertia": 1, "position": [-5, 1]}}, "forces": {"c": {"type": "contact", "i": "b", "j": "ground", "stiffness": 1e5}}}  # fmt: skip
    assert sets(scene([(1, 1), (0.5, 1)], **FAST), solver=solver) == ["p0", "p1", "f"]
    assert sets(scene([(1, 1), (0.5, 1)], **ball), solver=solver) == ["p0", "p1", "b"]


def test_many_mechanisms_are_solved_together_and_so_are_those_with_output_at_steps():
    assert len(sets(scene([(1, 1)] * 8))) == 8
    assert sets(scene([(1, 1)] * 9)) == []
    assert sets(scene([(1, 1)] * 2), points="steps") == []


def test_angles_are_those_of_pendulums_by_themselves():
    together = stiffmbs.run(scene([(1, 1), (0.5, 1.1), (0.8, 0.9)], **FAST), rtol=1e-9)
    for k, (angle, length) in enumerate([(1, 1), (0.5, 1.1), (0.8, 0.9)]):
        alone = stiffmbs.run(scene([(angle, length)]), rtol=1e-11)
        np.testing.assert_allclose(together[f"p{k}.angle"], alone["p0.angle"], atol=3e-7)


@pytest.mark.long
def test_a_study_has_the_numbers_of_its_runs_whether_they_are_solved_apart_or_together():
    given = scene([(1, 1)], **FAST)
    stiffness = [1e1, 1e5, 1e3]
    table = stiffmbs.sweep(given, {"forces.s.stiffness": stiffness}, outputs={"end": "final(p0.angle)"}, workers=1)
    for k, found in zip(stiffness, table["end"].values, strict=True):
        spring = {**FAST["forces"]["s"], "stiffness": k}
        assert found == stiffmbs.run(scene([(1, 1)], bodies=FAST["bodies"], forces={"s": spring}))["p0.angle"][-1]
