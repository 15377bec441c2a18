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


@pytest.mark.parametrize(
    ("part", "parameters", "message"),
    [
        ("double_wishbone", {"spring": "-60 N/mm"}, "stiffness: found -60000, expected zero or more (in p.strut)"),
        ("multi_link", {"strut_load": "-3 kN"}, "load: found -3000, expected zero or more"),
        ("macpherson", {"compression": "-900 N s/m"}, "compression: found -900, expected zero or more"),
        ("trailing_arm", {"bump_travel": "0 mm"}, "bump_travel: found 0, expected a value above zero"),
        ("anti_roll_bar", {"stiffness": "-700 N m/rad"}, "stiffness: found -700, expected zero or more"),
        ("steering_rack", {"k_b": -5e6}, "k_b: found -5e+06, expected zero or more"),
        ("double_wishbone", {"k_b": -1e7}, "k_b: found -1e+07, expected zero or more"),
    ],
)
def test_suspensions_of_negative_rates_are_refused(part, parameters, message):
    with pytest.raises(stiffmbs.InputError) as error:
        suspension(part, parameters)
    assert message in str(error.value)


def suspension(part, parameters):
    use = {"use": part, "on": "body", "parameters": parameters, "compliance": "bushing"}
    if part == "anti_roll_bar":
        use["mounts"] = {"left": "left", "right": "right"}
    bodies = {**FLYWHEELS["bodies"], "body": {"mass": 1000, "inertia": [300, 900, 900]}}
    return stiffmbs.read_scene(json.dumps({"dimensions": 3, "bodies": bodies, "parts": {"p": use}}))


@pytest.mark.parametrize("part", ["double_wishbone", "multi_link", "macpherson", "trailing_arm", "twist_beam"])
def test_stops_and_the_digression_of_a_suspension_are_those_of_its_strut(part):
    """The force 50 mm beyond the stops, and the damping at 1 m/s, by the values that the suspension has."""
    given = {"spring": "0 N/m", "strut_load": "0 N", "bump_travel": "30 mm", "rebound_travel": "40 mm", "bump_stiffness": "90 N/mm",
             "rebound_stiffness": "70 N/mm", "compression": "1000 N s/m", "rebound": "2000 N s/m", "digression": 0.25}  # fmt: skip
    forces = suspension(part, given).forces
    struts = [force for name, force in forces.items() if name.endswith("strut.strut")]
    assert struts
    for strut in struts:
        spring, damper = (dict(map(tuple, law.table)) for law in (strut.spring_law, strut.damper_law))
        assert spring[-0.09] == pytest.approx(-90e3 * 0.0525) and spring[0.08] == pytest.approx(70e3 * 0.035)
        assert damper[1.0] == pytest.approx(2000 * (0.2 + 0.25 * 0.8)) and damper[-1.0] == pytest.approx(-1000 * 0.4)


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
