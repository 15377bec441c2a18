"""Changes by `--set` of entries that repetitions and parts make, compared with a scene in which these are written out."""

import copy
import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.results.provenance import provenance_of
from stiffmbs.studies.sensitivities.parameters import Parameter, Scenes

BODY = {"mass": "k*m", "inertia": 0.01, "position": ["0.1*k + 0.1", "-L/2 + hip_y"]}
JOINT = {"type": "revolute", "i": {"body": "part{k}", "point": [0, "L/2"]}, "j": "shin"}
SPRING = {"type": "spring_damper", "i": "part{k}", "j": "mount", "stiffness": "100*k", "free_length": 0.1}
SHIN = {"mass": "m", "inertia": 0.02, "position": [0.1, "-L/2"]}
KNEE = {"type": "revolute", "i": {"body": "shin", "point": [0, "L/2"]}, "j": "mount"}
LEG = {
    "parameters": {"L": "L0", "hip": [0.1, 0.02], "m": "m0/2"},
    "bodies": {"shin": SHIN, "part{k}": {"for": "k in 1..2", **BODY}},
    "joints": {"knee": KNEE, "pin{k}": {"for": "k in 1..2", **JOINT}},
    "forces": {"spring{k}": {"for": "k in 1..2", **SPRING}},
}
INNER = {"for": "k in 1..2", "part": "leg", "on": "bar", "position": ["k", 0]}
PAIR = {
    "parameters": {"height": "0.1 m"},
    "bodies": {"bar": {"mass": 1, "inertia": 0.1, "position": [0, "-height"]}},
    "joints": {"fix": {"type": "revolute", "i": {"body": "bar", "point": [0, 0.1]}, "j": "mount"}},
    "use": {"leg{k}": INNER},
}
SCENE = {
    "parameters": {"m0": "2 kg", "L0": "0.4 m"},
    "gravity": [0, -9.81],
    "parts": {"leg": LEG, "pair": PAIR},
    "bodies": {
        "trunk": {"mass": 8, "inertia": 0.3, "position": [0.05, 0.02], "angle": 0.2},
        "link{k}": {"for": "k in 1..3", "mass": 1, "inertia": 0.1, "position": ["k", 5]},
    },
    "joints": {
        "hinge": {"type": "revolute", "i": {"body": "trunk", "point": [0.02, 0.1]}, "j": "ground"},
        "pin{k}": {
            "for": "k in 1..3", "type": "revolute", "i": {"body": "link{k}", "point": [0.1, 0]},
            "j": {"body": "ground", "point": ["k + 0.1", 5]},
        },
    },
    "use": {
        "front.left": {"part": "leg", "on": "trunk", "position": [0.3, 0], "angle": 0.3},
        "front.right": {"part": "leg", "on": "trunk", "position": [-0.3, 0], "mirror": "x", "parameters": {"L": "0.5 m"}},
        "rear": {"part": "pair", "on": "trunk", "position": [0.5, 0.2], "mirror": "y"},
        "w{k}": {"for": "k in 1..2", "part": "leg", "position": ["2*k", 1], "parameters": {"L": "0.2*k"}},
    },
    "run": {"duration": 0.2, "points": 3},
}  # fmt: skip
LEGS = ("front.left", "front.right", "rear.leg1", "rear.leg2", "w1", "w2")


def read(content, *changes):
    return stiffmbs.read_scene(json.dumps(content), changes)


def written_out():
    """Return the scene without repetitions, and with a definition of its own for each use."""
    found = copy.deepcopy(SCENE)
    leg, pair = found["parts"].pop("leg"), found["parts"].pop("pair")
    for section in ("bodies", "joints", "forces"):
        leg[section] = _repeated(leg[section])
    for section in ("bodies", "joints", "use"):
        found[section] = _repeated(found[section])
    pair["use"] = _repeated(pair["use"])
    for name in LEGS:
        found["parts"][_own(name)] = copy.deepcopy(leg)
        use = pair["use"][name[5:]] if name.startswith("rear.") else found["use"][name]
        use["part"] = _own(name)
    found["parts"]["pair"] = pair
    return found


def _own(name):
    return name.replace(".", "_")


def _repeated(entries):
    found = {}
    for name, entry in entries.items():
        if "for" not in entry:
            found[name] = entry
            continue
        for k in range(1, int(entry["for"][-1]) + 1):
            text = json.dumps({name: {key: value for key, value in entry.items() if key != "for"}})
            text = text.replace("{k}", str(k)).replace("k*", f"{k}*").replace("*k", f"*{k}").replace('"k', f'"{k}')
            found |= json.loads(text)
    return found


def edited(keys, value):
    found = written_out()
    at = found
    for key in keys[:-1]:
        at = at.setdefault(key, {}) if isinstance(at, dict) else at[key]
    at[keys[-1]] = value
    return read(found)


def of_leg(name, *keys):
    return ("parts", _own(name), *keys)


CHANGES = [
    ("bodies.link2.mass", 3.0, ("bodies", "link2", "mass")),
    ("joints.pin3.i.point.1", 0.3, ("joints", "pin3", "i", "point", 1)),
    ("bodies.front.left.shin.position.0", 0.12, of_leg("front.left", "bodies", "shin", "position", 0)),
    ("bodies.front.right.part2.position.0", 0.4, of_leg("front.right", "bodies", "part2", "position", 0)),
    ("joints.rear.leg2.pin1.i.point.0", 0.05, of_leg("rear.leg2", "joints", "pin1", "i", "point", 0)),
    ("forces.w2.spring2.stiffness", 90.0, of_leg("w2", "forces", "spring2", "stiffness")),
    ("use.front.left.parameters.L", 0.45, ("use", "front.left", "parameters", "L")),
    ("use.front.left.parameters.hip.1", 0.03, ("use", "front.left", "parameters", "hip_y")),
    ("use.front.left.parameters.hip_y", 0.03, ("use", "front.left", "parameters", "hip_y")),
    ("use.w2.parameters.L", 0.45, ("use", "w2", "parameters", "L")),
    ("use.w2.position.1", 1.1, ("use", "w2", "position", 1)),
    ("use.rear.leg2.parameters.L", 0.45, ("parts", "pair", "use", "leg2", "parameters", "L")),
    ("use.rear.leg1.position.0", 1.2, ("parts", "pair", "use", "leg1", "position", 0)),
    ("use.rear.parameters.height", 0.2, ("use", "rear", "parameters", "height")),
]


@pytest.mark.parametrize(("path", "value", "keys"), CHANGES, ids=[path for path, *_ in CHANGES])
def test_a_change_is_as_if_it_were_written(path, value, keys):
    found, expected, before = read(SCENE, (path, str(value))), edited(keys, value), read(written_out())
    for section in ("bodies", "joints", "forces", "markers"):
        assert getattr(found, section) == getattr(expected, section)
    assert any(getattr(found, section) != getattr(before, section) for section in ("bodies", "joints", "forces"))


@pytest.mark.parametrize(("path", "value", "keys"), CHANGES, ids=[path for path, *_ in CHANGES])
def test_the_number_at_a_path_is_the_one_that_a_change_sets(path, value, keys):
    """Numbers of parts are in their frames: setting the found one changes nothing."""
    scene = read(SCENE)
    parameter = Parameter(Scenes.of_model(scene), path)
    for same in (parameter.scene(parameter.value), read(SCENE, (path, repr(parameter.value)))):
        assert repr(same.bodies) == repr(scene.bodies)
        assert repr(same.joints) == repr(scene.joints)
        assert repr(same.forces) == repr(scene.forces)


def test_a_change_of_a_definition_reaches_all_uses_of_the_part():
    paths = {
        "parts.leg.bodies.part2.mass": 3.0,
        "parts.leg.parameters.hip.1": 0.04,
        "parts.pair.use.leg2.parameters.L": 0.35,
    }
    found = read(SCENE, *((path, str(value)) for path, value in paths.items()))
    assert {found.bodies[f"{name}.part2"].mass for name in LEGS} == {3.0}
    expected = copy.deepcopy(SCENE)
    expected["parts"]["leg"]["parameters"]["hip"] = [0.1, 0.04]
    before = read(expected, ("use.rear.leg2.parameters.L", "0.35"))
    assert {name: body.position for name, body in found.bodies.items()} == {
        name: body.position for name, body in before.bodies.items()
    }


def test_a_whole_repeated_entry_is_replaced():
    found = read(SCENE, ("bodies.link2", "{mass: 7, inertia: 1, position: [2, 5]}"))
    assert [found.bodies[f"link{k}"].mass for k in (1, 2, 3)] == [1, 7, 1]


def test_sensitivities_to_values_of_parts_are_those_of_differences():
    """The position of a body in a part on a rotated trunk was varied along the axes of the ground."""
    paths = {
        "bodies.front.left.shin.position.0": of_leg("front.left", "bodies", "shin", "position", 0),
        "use.front.right.parameters.L": ("use", "front.right", "parameters", "L"),
        "use.rear.leg2.parameters.L": ("parts", "pair", "use", "leg2", "parameters", "L"),
        "use.front.left.angle": ("use", "front.left", "angle"),
        "forces.front.left.spring2.stiffness": of_leg("front.left", "forces", "spring2", "stiffness"),
    }
    scene = read(SCENE)
    found = stiffmbs.sensitivities(scene, list(paths), "final(trunk.angle)").to
    for path, keys in paths.items():
        value = Parameter(Scenes.of_model(scene), path).value
        h = 1e-4 * abs(value)
        ends = [stiffmbs.run(edited(keys, value + s * h), rtol=1e-11)["trunk.angle"][-1] for s in (1, -1)]
        assert found[path] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-3, abs=1e-6)


def test_sensitivities_to_a_definition_are_those_of_all_its_uses_together():
    of = "final(trunk.angle)"
    names = ("front.left", "front.right", "rear.leg1", "rear.leg2")
    found = stiffmbs.sensitivities(
        read(SCENE), ["parts.leg.parameters.m", *(f"use.{name}.parameters.m" for name in names)], of
    ).to
    assert found["parts.leg.parameters.m"] == pytest.approx(
        sum(found[f"use.{name}.parameters.m"] for name in names), rel=1e-7
    )
    assert np.ptp([*found.values()]) > 1e-4


@pytest.mark.parametrize(("path", "reason"), [
    ("bodies.link9.mass", r"--set bodies.link9.mass: found no such place in the scene \(did you mean 'bodies.link"),
    ("bodies.front.left.part9.mass", r"found no such place in the scene \(did you mean 'bodies.front.left.part"),
    ("use.w3.parameters.L", r"found no such place in the scene \(did you mean 'use.w"),
    ("use.rear.leg3.parameters.L", r"found no such place in the scene \(did you mean 'use.rear.leg"),
    ("use.front.left.parameters.Q", r"scene, --set use.front.left.parameters.Q: found no such parameter of 'leg'"),
    ("parts.leg.parameters.Q", r"--set parts.leg.parameters.Q: found no such parameter of 'leg', expected one of L, hip, m"),
])  # fmt: skip
def test_a_change_without_effect_is_refused(path, reason):
    with pytest.raises(InputError, match=reason):
        read(SCENE, (path, "1"))


def test_a_wrong_parameter_of_a_placed_part_has_the_path_of_the_file():
    text = """
dimensions: 3
bodies: {chassis: {mass: 1000, inertia: [300, 900, 900]}}
parts: {front.bar: {use: anti_roll_bar, on: chassis, mounts: {left: chassis, right: chassis}}}
"""
    with pytest.raises(InputError, match=r"--set parts.front.bar.parameters.k: found no such parameter"):
        stiffmbs.read_scene(text, [("parts.front.bar.parameters.k", "1")])


@pytest.mark.parametrize(("path", "reason"), [
    ("parts.leg.bodies.shin.position.1", "which has the values -0.25, -0.2, -0.1 in the uses of the part, expected a path of one use"),
    ("parts.leg.parameters.Q", "it has no 'parameters.Q'"),
    ("parts.other.parameters.L", "which no use of a part takes, expected a path of a use, such as use.left.parameters.L"),
    ("use.front.left.parameters.hip", "which is a vector; add a place such as .0"),
])  # fmt: skip
def test_a_sensitivity_to_no_single_number_is_refused(path, reason):
    with pytest.raises(InputError, match=reason):
        Parameter(Scenes.of_model(read(SCENE)), path)


def test_studies_vary_values_of_parts_and_of_repeated_entries():
    paths = {
        "use.front.left.parameters.L": [0.3, 0.5],
        "forces.w1.spring2.stiffness": [50.0],
        "bodies.link2.mass": [2.0],
    }
    outputs = {"y": "final(front.left.shin.y)", "m": "final(w1.part2.y)"}
    table = stiffmbs.sweep(read(SCENE), paths, outputs=outputs)
    for k, length in enumerate((0.3, 0.5)):
        case = read(SCENE, ("use.front.left.parameters.L", str(length)), ("forces.w1.spring2.stiffness", "50"))
        expected = stiffmbs.run(case)
        assert table["y"].values.ravel()[k] == pytest.approx(expected["front.left.shin.y"][-1], abs=1e-7)
        assert table["m"].values.ravel()[k] == pytest.approx(expected["w1.part2.y"][-1], abs=1e-7)


def test_changes_hold_in_all_stages():
    """Those of entries of parts were left out after the first stage."""
    stages = {"stages": [{"run": {"duration": 0.1}}, {"run": {"duration": 0.1}, "change": {"gravity": [0, -5]}}]}
    paths = {
        "forces.front.left.spring2.stiffness": 33.0,
        "joints.pin2.i.point.1": 0.2,
        "joints.front.left.knee.i.point.0": 0.01,
    }
    scene = read({**SCENE, **stages, "run": {}}, *((path, str(value)) for path, value in paths.items()))
    for each in scene.stage_scenes:
        assert each.forces["front.left.spring2"].stiffness == 33.0
        assert each.joints["pin2"].i.point[1] == 0.2
        assert each.joints["front.left.knee"].i.point[0] == 0.01


def test_results_hold_the_changes_of_repeated_entries():
    scene = read(
        SCENE, ("bodies.link2.mass", "3"), ("use.w2.parameters.L", "0.3"), ("use.front.left.parameters.L", "0.3")
    )
    content, in_parts = provenance_of(scene).content()
    assert in_parts == {"bodies.link2.mass": "3", "use.w2.parameters.L": "0.3"}
    assert content["use"]["front.left"]["parameters"] == {"L": 0.3}


def test_a_part_of_the_package_takes_changes_for_all_its_uses():
    text = """
    dimensions: 3
    bodies: {body: {mass: 1000, inertia: [500, 500, 500]}}
    use:
      left: {part: macpherson, on: body}
      right: {part: macpherson, on: body, mirror: y}
    """
    found = stiffmbs.read_scene(text, [("parts.macpherson.parameters.upright_mass", "33")])
    assert {found.bodies[f"{side}.upright"].mass for side in ("left", "right")} == {33.0}
    with pytest.raises(InputError, match="found no such parameter of 'macpherson'"):
        stiffmbs.read_scene(text, [("parts.macpherson.parameters.uprightmass", "33")])
