"""Handling tests and K&C do not depend on where the sprung body has its origin."""

import copy
import json
from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs.reading.files.yaml_text import read_yaml
from stiffmbs.studies.handling import study
from stiffmbs.studies.handling.car import Manoeuvre, car_of, with_manoeuvre
from stiffmbs.studies.handling.standards import TESTS

EXAMPLES = Path(stiffmbs.__file__).parents[1] / "examples"
PLACES = ((1.25, 0.0, 0.0), (-0.4, 0.15, -0.2))
"""Origins of the chassis, from its centre of mass, m: at the front axle, and on no plane of the car."""
TRANSIENT = ("step5(t, 0.5, 0, 0.65, 5 mm)", "0.003*sin(6*t)*step5(t, 0, 0, 0.5, 1)")


def car_with_origin(place, changes=(), **entries):
    """Return the example car with its chassis described from another origin; nothing else changes."""
    content = read_yaml((EXAMPLES / "car.yaml").read_text(), "car.yaml")
    x, y, z = place
    content["bodies"]["chassis"] |= {
        "position": [f"{x!r} m", f"{y!r} m", f"height + ({z!r} m)"],
        "center_of_mass": [-x, -y, -z],
    }

    def moved(parts):
        found = copy.deepcopy(parts)
        for part in found.values():
            if part.get("on") == "chassis":
                own = part.get("position", ["0 m"] * 3)
                part["position"] = [f"({at or '0 m'}) - ({by!r} m)" for at, by in zip(own, place, strict=True)]
        return found

    content["parts"] = moved(content["parts"])
    for option in content["options"]["manoeuvre"].values():
        option["parts"] = moved(option["parts"])
    for tyre in content["forces"].values():
        tyre["properties"] = str(EXAMPLES / "car.tir")
    del content["requests"]
    return stiffmbs.read_scene(json.dumps(content | entries), changes)


def channels(scene, **manoeuvre):
    run = study.solved(with_manoeuvre(scene, car_of(scene), Manoeuvre(20.0, 1.5, **manoeuvre)))
    return {name: run[name] for name in run if name.startswith("vehicle.")}


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("steer", TRANSIENT)
def test_channels_of_a_manoeuvre_are_those_of_the_centre_of_mass(steer):
    """At the body's origin the sideslip gradient was -0.1 to -3.5 mrad/(m/s^2) for -2.63."""
    accurate = [("run.rtol", "1e-7"), ("run.solver", "auto")]
    expected = channels(car_with_origin((0.0, 0.0, 0.0), accurate), steer=steer)
    for place in PLACES:
        found = channels(car_with_origin(place, accurate), steer=steer)
        assert found.keys() == expected.keys()
        for name, values in expected.items():
            size = max(np.max(np.abs(values)), 0.05)
            assert found[name] == pytest.approx(values, abs=2e-4 * size), name


@pytest.mark.long
def test_the_reference_point_is_the_centre_of_mass_of_all_bodies_of_the_car():
    """A ball beside the road does not belong to it; a stated point counts as it is."""
    scene = car_with_origin((0.3, 0.1, 0.2))
    masses = np.array([each.mass for each in scene.bodies.values()])
    centre = masses @ [each.coordinates()[:3] for each in scene.bodies.values()] / masses.sum()
    car = car_of(scene)
    assert car.centre == pytest.approx(centre, abs=1e-12)
    assert car.reference == pytest.approx(centre - [0.3, 0.1, 0.75], abs=1e-12)
    assert car.behind(car.measured) == pytest.approx(centre[0] + 1.45)
    content = read_yaml((EXAMPLES / "car.yaml").read_text(), "car.yaml")
    ball = {"mass": 500, "inertia": [1, 1, 1], "position": [50, 8, 1]}
    scene = car_with_origin((0.0, 0.0, 0.0), bodies={**content["bodies"], "ball": ball})
    assert car_of(scene).centre == pytest.approx(centre, abs=1e-12)
    scene = car_with_origin((0.3, 0.1, 0.2), vehicle={"body": "chassis", "point": [0.5, 0, -0.1]})
    car = car_of(scene)
    assert car.point_given
    assert car.reference == (0.5, 0, -0.1)
    assert car.measured == pytest.approx((0.8, 0.1, 0.65))
    assert not car_of(car_with_origin((0.3, 0.1, 0.2), vehicle={"body": "chassis"})).point_given


@pytest.mark.long
def test_kinematics_and_compliance_do_not_depend_on_the_origin():
    """The roll centre was measured from the plane y = 0 of the body."""
    others = dict.fromkeys(("lateral", "lateral_parallel", "brake", "traction", "aligning", "aligning_parallel"), 0)
    sizes = {"points": 5, "bump": 20, "roll": 10, "steer": 5, **others}
    expected = stiffmbs.kinematics_and_compliance(car_with_origin((0.0, 0.0, 0.0)), **sizes)
    for place in PLACES[1:]:
        found = stiffmbs.kinematics_and_compliance(car_with_origin(place), **sizes)
        assert found.measures.keys() == expected.measures.keys()
        for name, value in expected.measures.items():
            assert found.measures[name] == pytest.approx(value, rel=1e-6, abs=1e-6, nan_ok=True), name
        for case, sweep in expected.sweeps.items():
            for name, values in sweep.channels.items():
                straight = np.abs(values) > 1e5
                kept = np.where(straight, 0.0, found.sweeps[case].channels[name])
                assert kept == pytest.approx(np.where(straight, 0.0, values), rel=1e-5, abs=1e-5, nan_ok=True), (
                    case,
                    name,
                )


@pytest.mark.long(100)
@pytest.mark.sampled(11)
@pytest.mark.parametrize("test", sorted(set(TESTS) - {"obstacle_avoidance", "ride"}, key="step_steer".__ne__))
def test_no_metric_of_any_test_depends_on_the_origin(test):
    accurate = [("run.rtol", "1e-7")]
    expected = stiffmbs.handling(car_with_origin((0.0, 0.0, 0.0), accurate), [test], workers=1)
    found = stiffmbs.handling(car_with_origin(PLACES[1], accurate), [test], workers=1)
    assert not found.tests[test].message
    for name, value in expected[test].items():
        assert found[test][name] == pytest.approx(value, rel=2e-3, abs=1e-3, nan_ok=True), name
