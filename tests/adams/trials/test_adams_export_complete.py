"""Datasets hold everything of a scene that changes its motion; the rest is refused or noted, by name."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.adams.export.dataset_text import written_dataset
from stiffmbs.adams.load import read_adams
from stiffmbs.commands.main import main
from stiffmbs.elements.element import Force
from stiffmbs.errors import AssemblyError, InputError, SolverError
from stiffmbs.reading.files.written_fields import Recording, unwritten, written
from stiffmbs.reading.table import Table
from tests.adams.test_adams_export import BETWEEN, BODIES
from tests.random_parts import CASES, random_element, refers_to_joints, three_bodies_in_space

TABLES = ("tables", "  smooth", "  straight", "  local")
"""Lines of `BODIES` without effect here."""
PENDULUM = """
name: pendulum
dimensions: 3
gravity: [0, 0, -9.81]
markers: {o: {orientation: {x: [1, 0, 0], z: [0, 1, 0]}}}
bodies:
  b:
    mass: 1
    inertia: [0.1, 0.1, 0.1]
    position: [1, 0, 0]
    markers: {h: {point: [-1, 0, 0], orientation: {x: [1, 0, 0], z: [0, 1, 0]}}}
joints: {j: {type: revolute, i: b.h, j: ground.o}}
"""
TURNED = "at_start: {set: {type: drive, joint: j, position: 1}}"


def _pendulum(more=""):
    return stiffmbs.read_scene(f"{PENDULUM}{more}")


@pytest.mark.parametrize(
    ("more", "named"),
    [
        ("start: settled", r"start \(describe the bodies"),
        ("start: {velocity: [0, 0, 0]}", r"start \(describe the bodies"),
        (TURNED, r"at_start \(describe"),
        ("stages: [{}, {change: {gravity: [0, 0, 0]}}]", r"stages \(write each stage"),
        ("run: {start: 1}", r"run\.start: a simulation of Adams starts at time 0"),
        ("run: {start: -2}\nstart: settled", "run.start: .*; start "),
    ],
)
def test_what_would_change_the_motion_is_refused_by_name(more, named):
    with pytest.raises(InputError, match=f"a dataset has no statement for {named}"):
        written_dataset(_pendulum(more))


@pytest.mark.parametrize(
    ("more", "note"),
    [
        ("figure: {y: [b.x]}", "the motion is the same.*figure"),
        ("notes: [made by hand]", "the motion is the same.*notes"),
        ("run: {solver: radau, max_order: 2}", "settings of this package.*run solver, run max_order"),
        ("run: {points: steps}", "settings of this package.*run points"),
        ("requests: {e: energy.total}", "requests e"),
        ("inputs: {push: 2 N}\nforces: {f: {type: force, i: b, force: [push, 0, 0]}}", "numbers: push"),
    ],
)
def test_what_keeps_the_motion_is_noted_by_name(more, note, tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(f"{PENDULUM}{more}\n")
    done = CliRunner().invoke(main, ["convert", str(scene), "-o", str(tmp_path / "out.adm")])
    assert done.exit_code == 0
    assert stiffmbs.load_scene(tmp_path / "out.adm").bodies
    assert re.search(note, done.output) and re.search(note, (tmp_path / "out.acf").read_text())


def test_nothing_is_noted_where_everything_is_written():
    assert written_dataset(_pendulum("run: {duration: 2, points: 11, rtol: 1e-8, max_step: 0.1}")).notes == ()


def _read_back(scene, folder: Path):
    found = written_dataset(scene)
    (folder / "again.adm").write_text(found.text)
    (folder / "again.acf").write_text(found.commands)
    return stiffmbs.load_scene(folder / "again.adm")


def test_a_start_in_equilibrium_and_settings_of_the_run_are_read_back(tmp_path):
    """At rest, whatever velocities are described."""
    moving = "mass: 1\n    velocity: [0, 0, 1]\n    omega: [0, -1, 0]"
    text = PENDULUM.replace("mass: 1", moving)
    scene = stiffmbs.read_scene(
        f"{text}start: equilibrium\nrun: {{duration: 2, points: 5, rtol: 1e-9, max_step: 0.05}}\n"
    )
    again = _read_back(scene, tmp_path)
    assert again.start == "equilibrium"
    assert (again.run.duration, again.run.points, again.run.rtol, again.run.max_step) == (2, 5, 1e-9, 0.05)
    one, other = stiffmbs.run(scene), stiffmbs.run(again)
    np.testing.assert_allclose(one["b.z"], -1, atol=1e-6)
    np.testing.assert_allclose(other[f"{next(iter(again.bodies))}.z"], one["b.z"], atol=1e-6)


def test_a_field_that_is_added_later_is_refused_until_it_is_written():
    class Newer(Table):
        beyond: str = "extend"

    points = ((0.0, 0.0), (1.0, 1.0))
    assert unwritten(Newer(table=points), "table") == ""
    assert unwritten(Newer(table=points, beyond="hold", lines=True), "table", "lines") == "beyond"
    recording = Recording({"table": {"lines": "a reason"}})
    stand_in = recording.of(Newer(table=points, beyond="hold", lines=True), "table", "curve")
    assert isinstance(stand_in, Table) and stand_in.table == points
    assert recording.refused() == [("table", "curve", "beyond")]
    assert "not written (a reason): table lines of curve" in recording.notes()
    written(stand_in)
    assert recording.refused() == [] and recording.notes() == []


FORCES = [(kind, form) for dimensions, kind, form in CASES if dimensions == 3 and issubclass(kind, Force)]


@pytest.mark.sampled(15)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("kind", "form"), FORCES, ids=lambda part: getattr(part, "kind", ""))
def test_random_forces_are_refused_or_move_alike(kind, form, seed):
    rng = np.random.default_rng([seed, *kind.kind.encode()])
    model = three_bodies_in_space(rng)
    force = random_element(kind, rng, form, 3)
    if refers_to_joints(force):
        pytest.skip("its joints are not part of the model")
    model.add("force", force)
    data = model.data()
    try:
        text = written_dataset(data).text
    except InputError as error:
        assert "force" in str(error)
        return
    again = read_adams(text)
    settings = {"duration": 0.05, "points": 3, "rtol": 1e-9}
    try:
        one = stiffmbs.run(data, **settings)
    except (AssemblyError, SolverError):
        pytest.skip("no motion")
    other = stiffmbs.run(again, **settings)
    for name, read in zip(data.bodies, again.bodies, strict=True):
        for axis in "xyz":
            np.testing.assert_allclose(other[f"{read}.{axis}"], one[f"{name}.{axis}"], atol=2e-7, err_msg=name)


@pytest.mark.sampled(12)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(12))
def test_random_scenes_are_refused_or_run_alike(seed, tmp_path):
    """With random starts, settings and velocities; the dataset runs by its own command file."""
    rng = np.random.default_rng(seed)
    kind = str(rng.choice([kind for kind in BETWEEN if kind not in ("tables", "planar")]))
    text = "\n".join(line for line in BODIES.splitlines() if not line.startswith(TABLES))
    run = {"duration": 0.1, "points": 3, "rtol": 1e-9} | ({"max_step": 0.01} if rng.random() < 0.5 else {})
    run |= {"start": 1.5} if rng.random() < 0.2 else {}
    omega = "omega: [0.1, 0.2, 0.3]" if rng.random() < 0.5 else "omega: [0, 0, 0]"
    start = rng.choice(["described", "equilibrium", "settled"], p=[0.6, 0.2, 0.2])
    text = f"{text.replace('omega: [0, 0, 0]', omega)}\n{BETWEEN[kind]}\nstart: {start}\nrun: {json.dumps(run)}\n"
    scene = stiffmbs.read_scene(text)
    if start == "settled" or "start" in run:
        with pytest.raises(InputError, match="a dataset has no statement for"):
            written_dataset(scene)
        return
    again = _read_back(scene, tmp_path)
    try:
        one = stiffmbs.run(scene)
    except (AssemblyError, SolverError):  # no equilibrium
        with pytest.raises((AssemblyError, SolverError)):
            stiffmbs.run(again)
        return
    other = stiffmbs.run(again)
    for name, read in zip(scene.bodies, again.bodies, strict=True):
        for axis in "xyz":
            np.testing.assert_allclose(other[f"{read}.{axis}"], one[f"{name}.{axis}"], atol=1e-6, err_msg=kind)
