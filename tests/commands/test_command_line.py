"""The command as its users run it: summary, JSON, files, and one sentence for every mistake."""

import csv
import errno
import json
import os
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main

from ..conftest import EXAMPLE_SCENES

SCENE = """
name: Cart on a rail
gravity: [0, -9.81]
bodies:
  cart: {mass: 10 kg, inertia: 1}
  bar: {mass: 1, inertia: 0.03, position: [0.3, 0]}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: cart, j: {body: bar, point: [-0.3, 0]}}
run: {duration: 0.2, points: 21}
"""


@pytest.fixture
def in_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE)
    return tmp_path


def stiffmbs(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_summary_says_what_was_solved_and_where_the_results_lie(in_folder):
    result = stiffmbs("run", "scene.yaml")
    assert result.exit_code == 0
    for part in ("Cart on a rail", "rail", "hinge", "energy", "bdf", "steps", "scene.results.npz"):
        assert part in result.output
    with np.load(in_folder / "scene.results.npz") as results:
        assert len(results["time"]) == 21
        assert "rail.fy" in results


def test_json_is_one_object_on_one_line(in_folder):
    result = stiffmbs("run", "scene.yaml", "--json")
    assert result.exit_code == 0
    assert result.output.count("\n") == 1
    report = json.loads(result.output)
    assert report["status"] == "done"
    assert report["time"] == {"start": 0.0, "end": 0.2}
    assert {"name", "steps", "residuals", "jacobians", "seconds"} <= report["solver"].keys()
    assert report["channels"]["rail.fy"].keys() == {"first", "last", "min", "max", "t_min", "t_max"}
    for name in ("cart.x", "cart.y", "cart.angle", "cart.vx", "cart.vy", "cart.omega", "hinge.torque",
                 "energy.kinetic", "energy.potential", "energy.total", "constraint.position", "constraint.velocity"):  # fmt: skip
        assert name in report["channels"]
    assert sorted(path.name for path in in_folder.iterdir()) == ["scene.yaml"]


@pytest.mark.parametrize("solver", ["bdf", "projected", "auto"])
def test_json_of_a_run_with_corners_and_events(in_folder, solver):
    forces = (
        "forces:\n  push: {type: force, i: cart, force: ['step(t, 0.05, 0, 0.1, 1)', 0]}\n"
        "  stop: {type: contact, i: bar, j: {body: ground, point: [0, -0.05]}, radius: 0.01, stiffness: 1e5}\n"
    )
    (in_folder / "scene.yaml").write_text(SCENE.replace("run:", f"{forces}run:"))
    result = stiffmbs("run", "scene.yaml", "--json", "--solver", solver, "--set", "run.scheme=dop853")
    assert result.exit_code == 0, result.output
    counted = json.loads(result.output)["solver"]
    assert counted["breakpoints"] == 2
    assert counted["events"] > 0


def test_files_hold_every_channel(in_folder):
    assert stiffmbs("run", "scene.yaml", "-o", "out.csv").exit_code == 0
    assert stiffmbs("run", "scene.yaml", "-o", "out.npz", "--json").exit_code == 0
    with (in_folder / "out.csv").open() as file:
        rows = list(csv.reader(file))
    with np.load(in_folder / "out.npz") as results:
        assert [head.partition(" (")[0] for head in rows[0]] == [name for name in results if "/" not in name]
        assert len(rows) == 1 + 21
        column = np.array([float(row[rows[0].index("bar.angle (rad)")]) for row in rows[1:]])
        np.testing.assert_array_equal(column, results["bar.angle"])


def test_values_can_be_set(in_folder):
    heavy = json.loads(stiffmbs("run", "scene.yaml", "--json", "--set", "bodies.cart.mass=20 kg").output)
    light = json.loads(stiffmbs("run", "scene.yaml", "--json").output)
    assert heavy["channels"]["rail.fy"]["first"] == pytest.approx(light["channels"]["rail.fy"]["first"] + 98.1)


def test_an_output_spacing_that_is_set_takes_the_place_of_points(in_folder):
    assert stiffmbs("run", "scene.yaml", "--set", "run.output=0.1", "-o", "out.npz").exit_code == 0
    with np.load(in_folder / "out.npz") as results:
        np.testing.assert_allclose(results["time"], [0, 0.1, 0.2])
    both = stiffmbs("run", "scene.yaml", "--set", "run.output=0.1", "--set", "run.points=3")
    assert "found both 'output' and 'points'" in both.output


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (("--set", "bodies.cart.mass=-1"), "scene.yaml, --set bodies.cart.mass: found -1"),
        (("--set", "run.rtol=x"), "scene.yaml, --set run.rtol: found the unknown name 'x'"),
        (("--rtol", "1e-20"), "scene.yaml, --set run.rtol: found 1e-20"),
        (("--set", "parameters={a: 2 x}"), "scene.yaml, --set parameters.a: found"),
        (("--set", "parameters.l=2"), "--set parameters.l: found no such parameter, expected one of none"),
        (
            ("--set", "l=2"),
            "l: found no such parameter, expected one of none, or a path such as forces.spring.stiffness",
        ),
        (("--set", "joints.rail.j=bar", "--set", "joints.rail.i=bar"), "scene.yaml, line 8, joints.rail: found 'bar'"),
    ],
)
def test_a_fault_in_what_was_set_is_not_looked_for_in_the_file(in_folder, change, place):
    assert place in stiffmbs("run", "scene.yaml", *change).output


def test_a_parameter_may_be_added_with_what_uses_it(in_folder):
    result = stiffmbs("run", "scene.yaml", "--json", "--set", "parameters.m=20 kg", "--set", "bodies.cart.mass=2*m")
    assert json.loads(result.output)["channels"]["rail.fy"]["first"] > 40 * 9.81


def test_one_of_a_repeated_entry_is_set_alone(examples):
    how = "equilibrium", examples / "chain.yaml", "--json", "--set", "N=3"
    before, after = (
        json.loads(stiffmbs(*how, *more).output)["channels"]["pin1.fy"]
        for more in ((), ("--set", "bodies.link3.mass=5"))
    )
    assert after - before == pytest.approx(4.9 * 9.81)
    result = stiffmbs(*how, "--set", "bodies.link4.mass=5")
    assert result.exit_code == 2
    assert "--set bodies.link4.mass: found no such place in the scene (did you mean 'bodies.link" in result.output


def test_a_scheme_can_be_chosen_and_a_setting_without_effect_is_told(in_folder):
    how = "run", "scene.yaml", "--json", "--duration", "0.1"
    explicit = json.loads(stiffmbs(*how, "--solver", "projected", "--scheme", "rk4", "--rtol", "1e-12").output)
    assert (explicit["solver"]["name"], explicit["solver"]["scheme"]) == ("projected", "rk4")
    assert "rtol = 1e-12 has no effect: rk4 reads scheme, step and projection" in explicit["notes"]
    implicit = json.loads(stiffmbs(*how, "--scheme", "rk4").output)
    assert any("scheme = rk4 has no effect: bdf reads" in note for note in implicit["notes"])
    refused = stiffmbs("run", "scene.yaml", "--scheme", "heun")
    assert refused.exit_code == 2 and "run.scheme: found 'heun', expected 'euler_cromer'" in refused.output


def test_solver_tolerance_and_duration_can_be_chosen(in_folder):
    report = json.loads(stiffmbs("run", "scene.yaml", "--json", "--solver", "projected", "--duration", "0.1").output)
    assert (report["solver"]["name"], report["time"]["end"]) == ("projected", 0.1)
    coarse, fine = (
        json.loads(stiffmbs("run", "scene.yaml", "--json", "--rtol", rtol).output)["solver"]["steps"]
        for rtol in ("1e-4", "1e-9")
    )
    assert fine > 2 * coarse


BAD = {
    "unknown key": ("bodies.cart.maas=3", "scene.yaml", "bodies.cart", "'maas'", "mass, inertia"),
    "unknown section": ("joint.rail=3", "'joint'", "joints"),
    "wrong type": ("bodies.cart.mass=[1, 2]", "bodies.cart.mass", "a list", "mass in kg"),
    "text for a number": ("bodies.cart.mass=heavy", "bodies.cart.mass", "'heavy'"),
    "truth value": ("bodies.cart.mass=true", "bodies.cart.mass", "truth value"),
    "number for a body": ("bodies.cart=3", "bodies.cart", "3", "mapping"),
    "unknown body": ("joints.rail.i=carr", "joints.rail.i", "'carr'", "cart, bar"),
    "unknown marker": ("joints.rail.i=cart.end", "joints.rail.i", "cart.end"),
    "zero mass": ("bodies.cart.mass=0", "bodies.cart.mass", "found 0", "greater than 0 kg"),
    "negative mass": ("bodies.cart.mass=-1 kg", "bodies.cart.mass", "-1 kg"),
    "not a number": ("bodies.cart.mass=.nan", "bodies.cart.mass", "nan", "finite"),
    "infinite": ("bodies.cart.position=[.inf, 0]", "bodies.cart.position", "inf"),
    "wrong unit": ("bodies.cart.mass=3 mm", "bodies.cart.mass", "3 mm", "kg"),
    "body without a name": ("bodies.={mass: 1, inertia: 1}", "bodies", "no"),
    "same name twice": ("joints.cart={type: fixed, i: bar, j: ground}", "cart", "bodies.cart has too"),
    "joint to itself": ("joints.hinge.j=cart", "joints.hinge", "'cart' on both sides"),
    "gravity with three numbers": ("gravity=[0, 0, -9.81]", "gravity", "3 values", "expected 2"),
    "unknown function": ("bodies.cart.mass=wibble(3)", "bodies.cart.mass", "'wibble'", "sqrt"),
    "unknown function in an equation": ("joints.e={type: equation, zero: gamma(cart.x)}", "joints.e.zero", "'gamma'"),
    "equation of nothing": ("joints.e={type: equation, zero: 1 + t}", "joints.e.zero", "coordinate"),
    "unknown type": ("joints.rail.type=slider", "joints.rail", "'slider'", "prismatic"),
    "no type": ("joints.rail={i: cart, j: ground}", "joints.rail", "type"),
    "missing field": ("joints.rail={type: prismatic, i: cart}", "joints.rail.j"),
    "duration of zero": ("run.duration=0", "run.duration", "found 0", "greater than 0 s"),
    "unknown solver": ("run.solver=euler", "run.solver", "'euler'", "bdf"),
    "rtol out of range": ("run.rtol=2", "run.rtol", "found 2"),
    "two grids": ("run={output: 0.1, points: 3}", "run", "'points'"),
    "more output than memory": ("run.points=100000000", "1e+08 output times", "at most 1e+07"),
    "unit meant as a request": ("requests={h: cart.x, twice: 2*h}", "requests", "'h' in '2*h'", "a unit and a request"),
    "no such place": ("bodies.cart.mass.unit=3", "bodies.cart.mass"),
    "no bodies": ("bodies={}", "bodies", "no body"),
    "reserved name": ("bodies.ground={mass: 1, inertia: 1}", "ground", "reserved"),
    "name no channel could bear": ('bodies.my cart={mass: 1, inertia: 1}', "my cart", "letters"),
}  # fmt: skip


@pytest.mark.parametrize("change", BAD.values(), ids=BAD.keys())
def test_wrong_input_gets_one_sentence(in_folder, change):
    setting, *parts = change
    result = stiffmbs("run", "scene.yaml", "-o", "out.csv", "--set", setting)
    assert result.exit_code == 2, result.output
    assert_one_sentence(result)
    for part in parts:
        assert part in result.output
    assert not (in_folder / "out.csv").exists()


def assert_one_sentence(result):
    assert isinstance(result.exception, SystemExit)
    assert result.output.strip().count("\n") == 0
    assert "Traceback" not in result.output


TEXTS = {
    "empty": ("", "empty scene"),
    "only a comment": ("# nothing\n", "empty scene"),
    "a list": ("- 1\n", "found a list, expected a scene"),
    "a word": ("hello", "found text without keys, expected a scene"),
    "no bodies": ("name: x\n", "bodies"),
    "not YAML": ("bodies: {a: [", "line 1"),
    "a tab": ("bodies:\n\tcart: 1\n", "line 2"),
    "a name twice": ("bodies:\n  a: {mass: 1, inertia: 1}\n  a: {mass: 2, inertia: 1}\n", "'a' twice"),
    "python object": ("bodies: !!python/object/apply:os.system [echo]\n", "YAML"),
    "nameless body": ("bodies:\n  '': {mass: 1, inertia: 1}\n", "no name"),
    "null name": ("bodies:\n  ~: {mass: 1, inertia: 1}\n", "no name"),
    "parameter in a circle": ("parameters: {a: b, b: a}\nbodies: {c: {mass: 1, inertia: 1}}\n", "parameters.a"),
    "parameter no number": ("parameters: {a: [1]}\nbodies: {c: {mass: 1, inertia: 1}}\n", "parameters.a"),
    "loop without a name": ("bodies:\n  c: {for: k in 1..3, mass: 1, inertia: 1}\n", "twice"),
    "loop that is none": ("bodies:\n  'c{k}': {for: 3, mass: 1, inertia: 1}\n", "k in 1..N"),
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS.keys())
def test_wrong_files_get_one_sentence(in_folder, text):
    (in_folder / "bad.yaml").write_text(text[0])
    result = stiffmbs("run", "bad.yaml")
    assert result.exit_code == 2, result.output
    assert_one_sentence(result)
    assert "bad.yaml" in result.output
    assert text[1] in result.output


def test_missing_unreadable_and_binary_files(in_folder):
    (in_folder / "binary.yaml").write_bytes(b"\xff\xfe\x00\x80")
    (in_folder / "folder").mkdir()
    for name in ("nowhere.yaml", "binary.yaml", "folder"):
        result = stiffmbs("run", name)
        assert result.exit_code == 2
        assert_one_sentence(result)
        assert name in result.output


def test_output_that_could_not_be_written_is_refused_before_solving(in_folder):
    for name in ("out.xls", "nowhere/out.csv", "out"):
        result = stiffmbs("run", "scene.yaml", "-o", name)
        assert result.exit_code == 2
        assert_one_sentence(result)


@pytest.mark.parametrize(
    "command",
    ["kc scene.yaml -o", "response scene.yaml --input cart.fx --output cart.x -o", "stresses scene.yaml cart -o"],
)
@pytest.mark.parametrize("name", ["nowhere/out.csv", "nowhere/out.xdmf", "out.xls", "out"])
def test_curves_that_could_not_be_written_are_refused_before_they_are_computed(in_folder, command, name):
    result = stiffmbs(*command.split(), name)
    assert result.exit_code == 2
    assert_one_sentence(result)
    assert result.output.startswith(f"stiffmbs: -o {name}: ")


def test_files_that_are_missing_in_the_end_show_in_the_exit_status(in_folder, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    asked = stiffmbs("run", "scene.yaml", "-o", "out.csv")
    assert asked.exit_code == 1
    assert "not written: out.csv: No space left on device" in asked.output
    assert stiffmbs("run", "scene.yaml").exit_code == 0
    assert sorted(path.name for path in in_folder.iterdir()) == ["scene.yaml"]


def test_json_also_reports_wrong_input(in_folder):
    result = CliRunner().invoke(main, ["run", "scene.yaml", "--json", "--set", "bodies.cart.mass=0"])
    report = json.loads(result.stdout)
    assert (result.exit_code, report["status"]) == (2, "error")
    assert "bodies.cart.mass" in report["message"]


@pytest.mark.long
def test_schema_accepts_the_examples_and_refuses_a_misspelt_key():
    import jsonschema
    from ruamel.yaml import YAML

    schema = json.loads(stiffmbs("schema").output)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for path in EXAMPLE_SCENES.values():
        scene = YAML(typ="safe").load(path)
        validator.validate(scene)
        scene["gravty"] = [0, 0]
        assert not validator.is_valid(scene)


def test_importing_the_package_needs_none_of_its_heavy_parts():
    code = "import sys, stiffmbs; print([m for m in ('sympy', 'numba', 'matplotlib', 'sksundae', 'rich') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


@pytest.mark.long
def test_a_scene_is_run_without_numba(in_folder, tmp_path, monkeypatch):
    monkeypatch.setenv("STIFFMBS_CACHE", str(tmp_path / "cache"))  # nothing compiled before
    without = "import sys; sys.modules['numba'] = None; from stiffmbs.commands.main import main; main()"
    found = subprocess.run(
        [sys.executable, "-c", without, "run", "scene.yaml", "--json"], capture_output=True, text=True
    )
    assert found.returncode == 0, found.stderr


def test_help_lists_every_command_in_one_section():
    lines = CliRunner().invoke(main, ["--help"]).output.splitlines()
    for name in main.files:
        (line,) = [line for line in lines if line.split()[:1] == [name]]
        assert line.startswith(f"  {name} "), line
    assert [line for line in lines if line.endswith(":") and not line.startswith(" ")][:2] == ["Options:", "Start:"]


@pytest.mark.parametrize("command", ["run", "report", "check"])
def test_a_command_without_a_scene_says_what_to_try(command):
    result = CliRunner().invoke(main, [command])
    assert result.exit_code == 2
    assert "Missing argument 'SCENE'" in result.output and "'stiffmbs init' writes a first scene" in result.output
