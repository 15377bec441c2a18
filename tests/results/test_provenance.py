"""Files, pages and figures hold the scene that was solved, its changes, the command, the version and the date."""

import html
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.results.provenance import provenance_of

EXAMPLES = Path(stiffmbs.__file__).parents[1] / "examples"
SCENE = """
name: sled
parameters: {k: 40 N/m}
bodies: {b: {mass: 1, inertia: 1, position: [0.2, 0]}}
joints: {rail: {type: prismatic, i: b, j: ground}}
forces: {s: {type: spring_damper, i: b, j: {body: ground, point: [-1, 0]}, stiffness: k, free_length: 1}}
figure: {y: [b.x]}
run: {duration: 0.2, points: 5}
"""
CHANGES = ["--set", "k=50", "--set", "start=settled", "--rtol", "1e-7", "--duration", "0.1"]
CHANGED = ("k = 50", "start = settled", "run.rtol = 1e-7", "run.duration = 0.1")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    (tmp_path / "scene.yaml").write_text(SCENE)
    return tmp_path


def _command(*arguments):
    done = CliRunner().invoke(main, list(arguments))
    assert done.exit_code == 0, done.output


def _check(found, output):
    assert found["changes"].splitlines() == list(CHANGED)
    assert found["command"] == f"stiffmbs run scene.yaml {' '.join(CHANGES)} -o {output}"
    assert (found["version"], found["date"]) == (stiffmbs.__version__, "1970-01-02T00:00:00Z")
    scene = json.loads(found["scene"])
    assert (scene["parameters"]["k"], scene["start"], scene["run"]["rtol"]) == (50, "settled", 1e-7)
    again = stiffmbs.run(stiffmbs.read_scene(found["scene"]))
    assert again.time[-1] == 0.1
    return again


@pytest.mark.parametrize("ending", ["npz", "nc", "csv", "tab", "res"])
def test_results_hold_the_scene_that_was_solved(folder, ending):
    pytest.importorskip("xarray")
    output = f"out.{ending}"
    _command("run", "scene.yaml", *CHANGES, "-o", output)
    match ending:
        case "npz":
            solution = stiffmbs.Solution.load(output)
            again = _check(solution.provenance.as_texts(), output)
            np.testing.assert_array_equal(again["b.x"], solution["b.x"])
        case "nc":
            import xarray

            _check(xarray.load_dataset(output).attrs, output)
        case _:
            _check(json.loads((folder / f"{output}-metadata.json").read_text()), output)
    if ending in ("npz", "nc", "csv"):
        assert stiffmbs.read_state(output).t == 0.1


def test_archives_of_earlier_versions_are_read(folder):
    _command("run", "scene.yaml", "-o", "out.npz")
    with np.load("out.npz") as archive:
        old = {name: archive[name] for name in archive.files if name != "run/provenance"}
    np.savez("old.npz", **old)
    assert stiffmbs.Solution.load("old.npz").provenance is None
    again = stiffmbs.Solution.load("old.npz")
    again.save("copy.csv")
    assert not (folder / "copy.csv-metadata.json").exists()


PAGES = [
    ("report", "scene.yaml", "--no-verify", "-o", "page.html"), ("animate", "scene.yaml", "-o", "page.html"),
    ("run", "scene.yaml", "--figure", "page.svg"), ("run", "scene.yaml", "--figure", "page.png"),
    ("plot", "scene.yaml", "b.x", "-o", "page.svg"), ("draw", "scene.yaml", "-o", "page.svg"), ("draw", "scene.yaml", "-o", "page.json"),
]  # fmt: skip


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("command", PAGES, ids=lambda command: f"{command[0]}-{command[-1]}")
def test_pages_and_figures_hold_the_scene_that_was_solved(folder, command):
    pytest.importorskip("matplotlib")
    _command(*command, *CHANGES)
    text = html.unescape((folder / command[-1]).read_bytes().decode("latin-1"))
    for expected in (*CHANGED, f"stiffmbs {command[0]} scene.yaml", "1970-01-02", "settled"):
        assert expected in text.replace("\\", ""), expected


@pytest.mark.long
def test_a_report_shows_the_file_of_an_unchanged_scene(folder):
    pytest.importorskip("jinja2")
    (folder / "scene.yaml").write_text(f"{SCENE}# as measured\n")
    _command("report", "scene.yaml", "--no-verify", "-o", "page.html")
    assert "# as measured" in (folder / "page.html").read_text()
    _command("report", "scene.yaml", "--no-verify", "-o", "page.html", "--set", "k=45")
    assert "# as measured" not in (folder / "page.html").read_text()


@pytest.mark.parametrize("ending", ["nc", "csv"])
def test_tables_of_studies_hold_the_scene(folder, ending):
    xarray = pytest.importorskip("xarray")
    _command("study", "scene.yaml", "--vary", "k=40,50", "--of", "final(b.x)", "--rtol", "1e-7", "-o", f"out.{ending}")
    if ending == "nc":
        found = xarray.load_dataset("out.nc").attrs
    else:
        found = json.loads((folder / "out.csv-metadata.json").read_text())
    assert found["changes"].splitlines() == ["run.rtol = 1e-7", "k is varied"]


@pytest.mark.long
def test_a_table_of_an_axle_and_its_figure_hold_the_scene(folder):
    pytest.importorskip("matplotlib")
    scene = str(EXAMPLES / "vehicles" / "bushing_axle.yaml")
    parameter = next(iter(stiffmbs.load_scene(scene).parameters))
    value = stiffmbs.load_scene(scene).parameters[parameter]
    _command(
        "kc",
        scene,
        "--axle",
        "",
        "--points",
        "5",
        "--set",
        f"{parameter}={value}",
        "-o",
        "kc.csv",
        "--figure",
        "kc.svg",
    )
    assert f"{parameter} = {value}" in json.loads((folder / "kc.csv-metadata.json").read_text())["changes"]
    assert f"{parameter} = {value}" in (folder / "kc.svg").read_text()


def test_settings_and_the_start_of_a_python_run_are_changes(folder):
    first = stiffmbs.run("scene.yaml")
    found = stiffmbs.run("scene.yaml", rtol=1e-9, points=None, output=0.05, start_from=first).provenance
    assert found.changes[:3] == ("run.start = 0.2", "run.output = 0.05", "run.points = None")
    assert found.changes[-1].startswith("start from the state at t = 0.2 s")
    assert found.scene["run"] == {"duration": 0.2, "start": 0.2, "output": 0.05, "rtol": 1e-9}


def test_a_model_and_stages_have_a_scene(folder):
    scene = stiffmbs.read_scene(SCENE)
    copy = scene.model_copy(update={"bodies": {"b": scene.bodies["b"].model_copy(update={"mass": 3.0})}})
    origin = stiffmbs.run(copy).provenance
    assert origin.scene["bodies"]["b"]["mass"] == 3.0 and origin.scene["run"] == {"duration": 0.2, "points": 5}
    again = stiffmbs.run(stiffmbs.read_scene(origin.scene_text))
    np.testing.assert_array_equal(again["b.x"], stiffmbs.run(copy)["b.x"])
    staged = stiffmbs.read_scene(f"{SCENE}stages: [{{run: {{duration: 0.1}}}}, {{run: {{duration: 0.1}}}}]\n")
    assert len(stiffmbs.run(staged).provenance.scene["stages"]) == 2


PARTS = """
parts: {link: {bodies: {bar: {mass: 1, inertia: 1}}}}
use: {left: {part: link}, right: {part: link}}
options: {load: {none: {}, heavy: {parameters: {m: 5}, run: {duration: 0.3}}}}
choose: {load: heavy}
"""


def test_changes_within_parts_and_choices_are_named():
    changes = [("bodies.left.bar.mass", "2"), ("run.duration", "0.1"), ("m", "6")]
    origin = provenance_of(stiffmbs.read_scene(PARTS, changes))
    assert "# run it with --set bodies.left.bar.mass=2" in origin.scene_text
    again = stiffmbs.read_scene(origin.scene_text, [("bodies.left.bar.mass", "2")])
    assert (again.bodies["left.bar"].mass, again.run.duration, again.parameters["m"]) == (2, 0.1, 6)
