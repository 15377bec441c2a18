"""Limits of the parameters of a part: values without a meaning are refused by name."""

import json

import pytest

import stiffmbs

FLYWHEELS = {
    "bodies": {name: {"mass": 1, "inertia": [1, 1, 1], "position": [0, y, 0]} for name, y in (("left", 1), ("right", -1))}
}  # fmt: skip


def placed(part, parameters, **words):
    mounts = {"differential": {"left": "left", "right": "right"}, "hydromount": {"load": "left"}, "powertrain": {"output": "left"},
              "driver": {"input": "left"}, "air_spring": {"above": "left"}}  # fmt: skip
    use = {"use": part, "parameters": parameters, "mounts": mounts[part], **words}
    return stiffmbs.read_scene(json.dumps({"dimensions": 3, **FLYWHEELS, "parts": {"p": use}}))


@pytest.mark.parametrize(
    ("part", "parameters", "words", "message"),
    [
        ("differential", {"split": 1.5}, {}, "parts.p.parameters.split: found 1.5, expected a value from 0 to 1"),
        (
            "differential",
            {"preload": "-5 N m"},
            {"locking": "limited_slip"},
            "preload: found -5, expected zero or more",
        ),
        ("powertrain", {"efficiency": 1.5}, {}, "efficiency: found 1.5, expected a value from 0 to 1"),
        ("powertrain", {"throttle": 5}, {}, "throttle: found 5, expected a value from 0 to 1"),
        ("hydromount", {"stiffness": [1, 1, -1]}, {}, "stiffness_z: found -1, expected zero or more"),
        ("air_spring", {"volume": "0 m^3"}, {}, "volume: found 0, expected a value above zero"),
        ("driver", {"target": "-5 m/s"}, {"drive": "none"}, "target: found -5, expected zero or more"),
    ],
)
def test_values_without_a_meaning_are_refused(part, parameters, words, message):
    with pytest.raises(stiffmbs.InputError) as error:
        placed(part, parameters, **words)
    assert message in str(error.value)


def own(limits):
    part = {"parameters": {"m": 2, "at": [0, 0, 1]}, "limits": limits, "bodies": {"b": {"mass": "m", "inertia": [1, 1, 1], "position": "at"}}}  # fmt: skip
    outside = {"n": 1, "m_x": -1}  # of the scene, which the limits of a part do not concern
    return json.dumps({"dimensions": 3, "parameters": outside, "parts": {"lump": part}, "use": {"p": {"part": "lump"}}})


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ({"m": "fraction"}, "use.p.parameters.m: found 2, expected a value from 0 to 1"),
        ({"at": "positive"}, "use.p.parameters.at_x: found 0, expected a value above zero"),
        ({"m": "small"}, "parts.lump.limits.m: found 'small', expected one of positive, nonnegative, fraction"),
        ({"n": "positive"}, "parts.lump.limits: found 'n', expected a parameter of the part"),
        ([1], "parts.lump.limits: found"),
    ],
)
def test_limits_of_own_parts(limits, message):
    with pytest.raises(stiffmbs.InputError) as error:
        stiffmbs.read_scene(own(limits))
    assert message in str(error.value)
    stiffmbs.read_scene(own({"m": "positive", "at": "nonnegative"}))
