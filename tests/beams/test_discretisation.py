"""Estimated discretisation errors against converged values, and numbers of elements by a tolerance."""

import json
import re

import numpy as np
import pytest

import stiffmbs
from stiffmbs import BeamBody, InputError, Model, SolverError, read_scene
from stiffmbs.analyses.beam_elements import discretisation

from .scenes import bend, cantilever, flying_in_space, pendulum, princeton, right_angle

BEND, STRIP = ("bend.end.x", "bend.end.y", "bend.end.z"), ("strip.end.x", "strip.end.y", "strip.end.z")
ROD = ("rod.end.x", "rod.end.y", "rod.end.z")
AT_REST = {
    "elastica": (
        lambda n: cantilever(n, force="[0, 5]", stiffness="[1e8, 1e8, 1]"),
        dict(zip(STRIP[:2], (1 - 0.38762836, 0.71379152), strict=True)),
    ),
    "bend": (lambda n: bend(n, 600, 5e6 / 6), dict(zip(BEND, (47.150439, 15.684801, 53.474859), strict=True))),
    "twisted bend": (
        lambda n: bend(n, 600, 0.140577 * 5e6),
        dict(zip(BEND, (46.891925, 15.557786, 53.607369), strict=True)),
    ),
    "princeton": (
        lambda n: princeton(n, 13.345, 45),
        dict(zip(STRIP, (0.508 - 0.030361114, 0.156587823, 0.015342258), strict=True)),
    ),
}
MOVING = {
    "pendulum": (pendulum, dict(zip(ROD, (0.4365307, -0.8979809), strict=False))),
    "pendulum in space": (lambda n: pendulum(n, 3), dict(zip(ROD, (0.1955840, 0.4683335, -0.8644481), strict=True))),
    "spaghetti": (flying_in_space, {"rod.start.x": 19.213600, "rod.start.y": 1.625556, "rod.start.z": -2.127248}),
    "frame": (right_angle, {"frame.elbow.z": 4.642067, "frame.end.z": 3.508934}),
}


def spectral(text):
    between = "\n    " if "\n    elements" in text else ", "
    return re.sub(r"(elements: *\d+)", rf"\1{between}interpolation: spectral", text)


def compare(problem, n, form, solve):
    make, expected = problem
    scene = read_scene(form(make(n)))
    found = solve(scene)
    errors, _ = discretisation(scene, found, solve)
    for name, value in expected.items():
        error = abs(found[name][-1] - value)
        assert error < 2 * errors[name] + 1e-6 * abs(value), name
    return max(errors[name] for name in expected)


@pytest.mark.long
@pytest.mark.sampled(9)
@pytest.mark.parametrize("form", [str, spectral], ids=["pairs", "spectral"])
@pytest.mark.parametrize("name", AT_REST)
def test_the_error_at_rest_is_within_twice_the_estimate(name, form):
    errors = [compare(AT_REST[name], n, form, lambda scene: stiffmbs.equilibrium(scene).solution) for n in (4, 8)]
    assert errors[0] > 2.5 * errors[1]


@pytest.mark.long
@pytest.mark.parametrize(
    "form", [str, pytest.param(spectral, marks=(pytest.mark.long, pytest.mark.sampled(3)))], ids=["pairs", "spectral"]
)
@pytest.mark.parametrize("name", MOVING)
def test_the_error_of_a_motion_is_within_twice_the_estimate(name, form):
    compare(MOVING[name], 8, form, lambda scene: stiffmbs.run(scene, solver="radau"))


@pytest.mark.long
def test_verification_reports_the_discretisation(tmp_path):
    from click.testing import CliRunner

    from stiffmbs.commands.main import main

    file = tmp_path / "rod.yaml"
    file.write_text(pendulum(8))
    found = CliRunner().invoke(main, ["run", str(file), "--verify", "--json", "--set", "run.solver=radau"])
    result = json.loads(found.stdout)
    assert any("4 instead of 8 elements of rod): errors of at most about" in one for one in result["verification"])
    assert 2e-3 < result["channels"]["rod.end.x"]["discretisation"] < 2e-2


@pytest.mark.long
def test_an_odd_node_of_a_joint_is_kept_by_a_finer_beam():
    text = cantilever(5, force="[0, 5]").replace("i: strip.end, force", "i: strip.node3, force")
    verified = stiffmbs.verify(read_scene(text + "run: {duration: 0.01}"), solver="radau")
    assert "10 instead of 5 elements" in verified.verification[-1]


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("tolerance", "spare"), [("{tolerance: 1 mm}", 1e-3), ("{tolerance: 1e-5 m}", 1e-5), ("auto", 5.08e-4)]
)
def test_elements_by_a_tolerance(tolerance, spare):
    text = princeton(8, 13.345, 45).replace("elements: 8", f"elements: {tolerance}")
    found = stiffmbs.equilibrium(read_scene(text))
    assert [found.channels[name] for name in STRIP[1:]] == pytest.approx([0.156587823, 0.015342258], abs=spare)
    assert re.search(r"beam strip: \d+ elements, estimated position error", " ".join(found.notes))


@pytest.mark.long
def test_elements_by_a_tolerance_of_a_run_and_in_a_part():
    part = """
gravity: [0, -9.81]
parts:
  whip:
    bodies: {rod: {type: beam, start: [0, 0], end: [1, 0], elements: {tolerance: 5 mm},
                   section: {type: circle, diameter: 20 mm}, material: {E: 5 MPa, nu: 0.3, density: 1100 kg/m^3}}}
    joints: {pin: {type: revolute, i: rod.start, j: mount}}
use: {a: {part: whip}}
run: {duration: 0.4 s, points: 3, rtol: 1e-8, solver: radau}
"""
    found = stiffmbs.run(read_scene(part))
    assert [found["a.rod.end.x"][-1], found["a.rod.end.y"][-1]] == pytest.approx([0.4365307, -0.8979809], abs=5e-3)
    assert "beam a.rod: " in " ".join(found.notes)
    assert found["a.rod.node2.x"][0] == pytest.approx(0.5)  # a quarter of the length each, whatever the number


def test_a_number_for_each_interval():
    text = cantilever("[2, 5]").replace("stiffness", "stations: {load: 0.9}, stiffness")
    scene = read_scene(text)
    assert np.diff([body.position[0] for body in scene.bodies.values()]) == pytest.approx([0.45] * 2 + [0.02] * 5)
    with pytest.raises(InputError, match=r"strip.elements: found 3 numbers, expected 2, one for each interval"):
        read_scene(text.replace("[2, 5]", "[2, 5, 1]"))


@pytest.mark.long
def test_bad_tolerances_are_reported(monkeypatch):
    monkeypatch.setattr("stiffmbs.analyses.beam_elements.MOST", 16)
    text = princeton(8, 13.345, 45)
    for bad, expected in (
        ("{tolerance: 0}", "strip.elements: found 0, expected a length greater than 0"),
        ("{tolerance: 1 N}", "strip.elements: found '1 N'"),
        ("{number: 3}", "expected a number, auto, or {tolerance: 1 mm}"),
        ("[1.5]", "found 1.5, expected a whole number of elements"),
    ):
        with pytest.raises(InputError, match=re.escape(expected)):
            read_scene(text.replace("elements: 8", f"elements: {bad}"))
    with pytest.raises(SolverError, match=r"bodies.strip.elements: found an estimated error of .* expected 1e-12 m"):
        stiffmbs.equilibrium(read_scene(text.replace("elements: 8", "elements: {tolerance: 1e-12}")))
    with pytest.raises(InputError, match="found a tolerance, expected a number"):
        stiffmbs.modes(read_scene(text.replace("elements: 8", "elements: auto")))
    with pytest.raises(InputError, match=r"b.elements: found a tolerance in a model built in Python"):
        Model().add("b", BeamBody(start=(0, 0), end=(1, 0), elements="auto", stiffness=(1, 1, 1), mass_per_length=1, inertia_per_length=1))  # fmt: skip
