"""Files that a scene names: a study's store, what a process keeps, and the cache of scenes all follow from their content."""

import importlib
import os
import re
import shutil
import subprocess
import sys
import textwrap

import numpy as np
import pytest

from stiffmbs import InputError, sweep
from stiffmbs.reading.files.own_sources import digests_of_code

WHEEL = """
dimensions: 3
gravity: [0, 0, -9.81]
roads: {{field: {road}}}
bodies: {{wheel: {{mass: 100, inertia: [1, 1, 1], position: [2, 5, 0.29], velocity: [0, 0, 0], geometry: [{mesh}]}}}}
joints: {{upright: {{type: orientation, i: wheel, j: ground}}}}
forces: {{tyre: {tyre}}}
run: {{duration: 0.05, points: 3}}
"""
VERTICAL = "{type: vertical_tyre, i: wheel, radius: 0.3, stiffness: 1e5, damping: 2000, road: field}"
FLAT = "{type: flat}"
GRID = "4 6\n0 0 0\n10 0 0\n"
BALL = """
bodies: {b: {mass: 1, inertia: 1, position: [1, 0]}}
forces: {pull: {type: own_pull, i: b}}
run: {duration: 0.1, points: 3}
"""
OWN = """
import stiffmbs
import helper


@stiffmbs.register
class OwnPull(stiffmbs.Force):
    kind = "own_pull"
    i: stiffmbs.Marker

    @staticmethod
    def efforts(e):
        return [(-helper.law(e.i.point[0]), e.i.point[0])]
"""
HELPER = "STIFFNESS = 10\n\n\ndef law(x):\n    return STIFFNESS * x\n"


PROGRAM = """
import sys
import own, stiffmbs
print(float(stiffmbs.sweep("scene.yaml", {"bodies.b.mass": [1.0]}, outputs=["final(b.x)"], store=sys.argv[1])["final(b.x)"][0]))
"""


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("file", "old", "new"),
    [("own.py", "-helper", "-2 * helper"), ("helper.py", "= 10", "= 20"), ("helper.py", "* x", "* x**3")],
)
def test_users_own_code_is_part_of_a_store(tmp_path, file, old, new):
    for name, text in (("scene.yaml", BALL), ("own.py", OWN), ("helper.py", HELPER), ("program.py", PROGRAM)):
        (tmp_path / name).write_text(textwrap.dedent(text))
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])}

    def session(store):
        command = [sys.executable, "-B", "program.py", store]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)

    first = session("rows")
    assert first.stdout == session("rows").stdout, first.stderr
    path = tmp_path / file
    path.write_text(path.read_text().replace(old, new))
    again = session("rows")
    assert re.search(f"rows of another study, in which '.*{file}'", again.stderr), again.stderr
    assert session("others").stdout != first.stdout


def test_code_that_was_edited_after_it_was_loaded_is_told_from_its_file():
    def law(gain):
        return lambda x: gain * x

    assert digests_of_code([law(1.0)]) == digests_of_code([law(1.0)])
    assert digests_of_code([law(1.0)]) != digests_of_code([law(2.0)])


def test_types_of_numbers_in_code_have_a_digest():
    """The type numpy.bool in a table of a function was a traceback."""

    types = {np.bool_: 1.0, np.float64: 2.0}

    def law(x):
        return x * types[type(x)]

    assert digests_of_code([law])


def test_packages_of_an_extended_environment_are_not_the_users_code(tmp_path, monkeypatch):
    folder = tmp_path / "other" / "lib" / "site-packages"
    folder.mkdir(parents=True)
    (folder / "installed_elsewhere.py").write_text("def law(x):\n    return x\n")
    monkeypatch.syspath_prepend(folder)
    law = importlib.import_module("installed_elsewhere").law
    assert digests_of_code([lambda x: law(x)]).keys() == digests_of_code([lambda x: x]).keys()


@pytest.mark.long
def test_a_file_that_cases_name_is_part_of_the_store(tmp_path):
    text = WHEEL.format(road="{type: grid, file: a.txt}", mesh="", tyre=VERTICAL)
    (tmp_path / "scene.yaml").write_text(text)
    for name in ("a.txt", "b.txt"):
        (tmp_path / name).write_text(GRID)
    study = {
        "vary": {"roads.field.file": ["a.txt", "b.txt"]},
        "outputs": ["final(wheel.z)"],
        "store": tmp_path / "rows",
    }
    sweep(tmp_path / "scene.yaml", **study)
    (tmp_path / "b.txt").write_text(GRID.replace("10 0 0", "10 .1 .1"))
    with pytest.raises(InputError, match=r"in which '.*b.txt' had different content"):
        sweep(tmp_path / "scene.yaml", **study)


@pytest.mark.long
def test_a_file_that_changes_during_a_study_ends_it(tmp_path):
    """The cases that are done are kept, and belong to the first content."""
    (tmp_path / "scene.yaml").write_text(WHEEL.format(road="{type: grid, file: a.txt}", mesh="", tyre=VERTICAL))
    (tmp_path / "a.txt").write_text(GRID)

    def edited(done, *_):
        (tmp_path / "a.txt").write_text(GRID.replace("10 0 0", "10 .1 .1"))

    study = {
        "vary": {"roads.field.friction": [1.0, 0.9, 0.8]},
        "outputs": ["final(wheel.z)"],
        "store": tmp_path / "rows",
    }
    with pytest.raises(InputError, match=r"'.*a.txt' has changed since the scene was read"):
        sweep(tmp_path / "scene.yaml", **study, watch=edited)
    with pytest.raises(InputError, match=r"in which '.*a.txt' had different content"):
        sweep(tmp_path / "scene.yaml", **study)
    (tmp_path / "a.txt").write_text(GRID)
    seen = []
    sweep(tmp_path / "scene.yaml", **study, watch=lambda done, *_: seen.append(done))
    assert seen == [2, 3]


def test_the_scene_itself_and_other_parts_are_named(tmp_path, examples):
    shutil.copy(examples / "cart_pendulum.yaml", tmp_path)
    scene, store = tmp_path / "cart_pendulum.yaml", tmp_path / "rows"
    sweep(scene, L=[0.5], duration=0.1, store=store)
    with pytest.raises(InputError, match="in which the settings had"):
        sweep(scene, L=[0.5], duration=0.1, rtol=1e-5, store=store)
    with pytest.raises(InputError, match="in which the varied values had"):
        sweep(scene, L=[0.6], duration=0.1, store=store)
    scene.write_text(scene.read_text().replace("cart:", "cart: ", 1) + "notes: [more]\n")
    with pytest.raises(InputError, match="in which the scene had"):
        sweep(scene, L=[0.5], duration=0.1, store=store)
