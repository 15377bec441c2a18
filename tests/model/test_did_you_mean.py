"""Misspelt names are reported with the nearest valid name."""

import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.reading.did_you_mean import did_you_mean

PARTS = """
dimensions: 3
parts:
  arm:
    parameters: {length: 0.3 m}
    options: {support: {pin: {joints: {hinge: {type: revolute, i: beam, j: mount}}}, soft: {}}}
    mounts: {frame: ground}
    bodies: {beam: {mass: 1, inertia: [1, 1, 1], markers: {tip: {point: [length, 0, 0]}}}}
    forces: {spring: {type: spring_damper, i: beam.tip, j: ground, stiffness: 10}}
use: {left: {part: arm}}
"""


@pytest.mark.parametrize(
    ("path", "value", "name"),
    [
        ("startt", "1", "start"),
        ("parameters.startt", "1", "start"),
        ("runn.duration", "1", "run"),
        ("run.duraton", "1", "duration"),
        ("run.Duration", "1", "duration"),
        ("run.solver", "bfd", "bdf"),
        ("bodies.baar.mass", "1", "bar"),
        ("bodies.bar.mas", "1", "mass"),
        ("bodies.bar.markers.end.pont", "[0, 0]", "point"),
        ("joints.hinge.type", "revolut", "revolute"),
        ("joints.hinge.j", "bra", "bar"),
        ("joints.hinge.i", "bar.lower_edn", "lower_end"),
        ("forces.sprng.stiffness", "1", "spring"),
        ("forces.spring.stifness", "1", "stiffness"),
        ("forces.spring.stiffness", "2*strt", "start"),
        ("forces.spring.stiffness", "2*sqrtt(4)", "sqrt"),
        ("figure.titel", "x", "title"),
        ("requests.r", "baar.x", "bar"),
        ("requests.r", "energy.totl", "total"),
    ],
)
def test_a_misspelt_path_names_the_nearest_key(examples, path, value, name):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    assert scene is not None
    changes = [("bodies.bar.markers.lower_end", "{point: [0, 0]}"), (path, value)]
    with pytest.raises(stiffmbs.InputError, match=rf"\(did you mean '{name}'\?\)"):
        stiffmbs.load_scene(examples / "cart_pendulum.yaml", changes)


@pytest.mark.parametrize(
    ("path", "value", "name"),
    [
        ("use.left.suport", "pin", "support"),
        ("use.left.support", "pni", "pin"),
        ("choose.suport", "pin", "support"),
        ("use.left.part", "amr", "arm"),
        ("use.left.parameters.lenght", "1", "length"),
        ("use.left.mounts.fram", "ground", "frame"),
        ("use.leftt.parameters.length", "1", "left"),
        ("forces.leftt.spring.stiffness", "1", "left"),
        ("forces.left.sprng.stiffness", "1", "forces.left.spring"),
        ("forces.left.spring.stifness", "1", "stiffness"),
        ("parts.arm.bodis.x", "1", "bodies"),
    ],
)
def test_a_misspelt_path_in_a_part_names_the_nearest_key(path, value, name):
    assert stiffmbs.read_scene(PARTS).bodies
    with pytest.raises(stiffmbs.InputError, match=rf"\(did you mean '{name}'\?\)"):
        stiffmbs.read_scene(PARTS, [(path, value)])


def test_a_path_below_an_entry_that_the_scene_does_not_have_is_named(examples):
    with pytest.raises(
        stiffmbs.InputError, match=r"--set forces.x.stiffness: found no 'x' in forces, expected an entry"
    ):
        stiffmbs.load_scene(examples / "cart_pendulum.yaml", [("forces.x.stiffness", "1")])
    new = [("bodies.x.mass", "1"), ("bodies.x.inertia", "1")]
    assert "x" in stiffmbs.load_scene(examples / "cart_pendulum.yaml", new).bodies


def test_a_change_of_joints_at_the_start_needs_none_in_the_file(examples):
    held = [("at_start.push", "{type: drive, joint: hinge, velocity: 1}")]
    assert stiffmbs.load_scene(examples / "cart_pendulum.yaml", held).at_start
    with pytest.raises(stiffmbs.InputError, match=r"found no 'hing' in joints \(did you mean 'hinge'\?\)"):
        stiffmbs.load_scene(examples / "cart_pendulum.yaml", [("at_start.hing.velocity", "1")])


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (["run", "SCENE", "--duraton", "3"], "--duration"),
        (["sensitivities", "SCENE", "--to", "LL", "--of", "peak(rail.fy)"], "L"),
        (["sensitivities", "SCENE", "--to", "L", "--of", "peak(rial.fy)"], "rail.fy"),
        (["study", "SCENE", "--vary", "startt=1,2"], "start"),
        (["study", "SCENE", "--vary", "start=1,2", "--of", "paek(rail.fy)"], "peak"),
        (["compare", "SCENE", "--solver", "bfd"], "bdf"),
        (["compare", "SCENE", "--measure", "positins"], "positions"),
        (["response", "SCENE", "--input", "cart.fxx", "--output", "cart.x"], "cart.fx"),
        (["run", "SCENE", "--set", "run.drop_first=[hing]"], "hinge"),
        (["rum", "SCENE"], "run"),
    ],
)
def test_a_misspelt_name_on_the_command_line_names_the_nearest_one(examples, words, name):
    result = CliRunner().invoke(
        main, [str(examples / "cart_pendulum.yaml") if word == "SCENE" else word for word in words]
    )
    assert result.exit_code == 2
    assert f"id you mean '{name}'?" in result.output


def test_a_misspelt_name_in_python_names_the_nearest_one():
    model = stiffmbs.Model("Bar")
    bar = model.add("bar", stiffmbs.Body(mass=1, inertia=1))
    model.add("hinge", stiffmbs.Revolute(i="bar", j="ground"))
    for name, wrong in {
        "duration": lambda: model.run(duraton=3), "mass": lambda: bar.mas, "hinge": lambda: model.remove("hing"),
        "hinge.fx": lambda: model.run(duration=0.1)["hinge.fxx"],
    }.items():  # fmt: skip
        with pytest.raises((stiffmbs.InputError, AttributeError), match=rf"\(did you mean '{name}'\?\)"):
            wrong()


def test_only_a_similar_name_is_suggested():
    assert did_you_mean("colour", ["mass", "stiffness"]) == ""
    assert did_you_mean(10**5000, [3]) == ""
    assert did_you_mean("bar.z", ["bar.x", "bar.y"]) == did_you_mean("third", ["other"]) == ""
    assert (
        did_you_mean("bar.vxx", ["bar.vx", "cart.vxx"])
        == did_you_mean("baar.vx", ["bar.vx"])
        == " (did you mean 'bar.vx'?)"
    )
    assert did_you_mean("MASS", ["mass", "masses"]) == " (did you mean 'mass'?)"
    assert len(did_you_mean("x" * 100_000, ["x" * 99])) < 100
