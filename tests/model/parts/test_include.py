"""Scenes that include other files."""

import io
import json
import re
import sys
from pathlib import Path

import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.model.schema import scene_schema
from stiffmbs.reading.files.include import PLACES
from tests.flexible_bodies.bars import mesh_of_bar

ROOT = Path(__file__).parents[3]

BODIES = "bodies:\n  bar: {mass: m, inertia: 1, markers: {end: {point: [1, 0]}}}\n"
JOINTS = "joints:\n  pin: {type: revolute, i: bar.end, j: ground}\n"


@pytest.fixture
def write(tmp_path):
    def written(**files):
        for name, text in files.items():
            path = tmp_path / f"{name.replace('__', '/')}.yaml"
            path.parent.mkdir(exist_ok=True)
            path.write_text(text)
        return tmp_path / f"{next(iter(files))}.yaml"

    return written


def test_sections_are_put_together(write):
    main = "include: [parameters.yaml, sub/joints.yaml]\ngravity: [0, -9.81]\nrun: {duration: 1}\n" + BODIES
    path = write(
        main=main,
        parameters="parameters: {m: 2}",
        sub__joints="include: more.yaml\n" + JOINTS,
        sub__more="run: {points: 3}",
    )
    scene = stiffmbs.load_scene(path, [("m", "3")])
    assert scene.bodies["bar"].mass == 3
    assert scene.joints["pin"].i.label == "bar.end"
    assert (scene.run.duration, scene.run.points) == (1, 3)


def test_names_of_files_start_from_the_working_folder_without_a_file(write, tmp_path, monkeypatch):
    write(main="parameters: {m: 2}\n" + BODIES)
    monkeypatch.chdir(tmp_path)
    assert stiffmbs.read_scene("include: main.yaml").bodies["bar"].mass == 2
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"include: main.yaml")))
    assert stiffmbs.load_scene("-").bodies["bar"].mass == 2


@pytest.mark.parametrize(
    ("main", "files", "reason"),
    [
        ("include: none.yaml", {}, "main.yaml, line 1, include: found no such file"),
        ("include: main.yaml", {}, "includes itself"),
        ("include: a.yaml", {"a": "include: b.yaml", "b": "include: a.yaml"}, "a.yaml, .* circle|b.yaml, line 1, include: .*itself"),
        ("include: [a.yaml, b.yaml]", {"a": BODIES, "b": BODIES}, r"found 'bodies.bar' in .*a.yaml and in .*b.yaml"),
        ("include: a.yaml\ngravity: [0, 1]", {"a": "gravity: [0, 2]"}, "found 'gravity' in .*a.yaml and in .*main.yaml"),
        ("include: 3", {}, "found 3, expected the name of a YAML file"),
        ('include: "-"', {}, "expected the name of a YAML file"),
        ('include: ["a\\0b"]', {}, "found"),
        ("include: {a: b}", {}, "found {'a': 'b'}, expected the name of a YAML file"),
        ("include: .", {}, "found no such file"),
        ("include: /dev/zero", {}, "found no such file"),
        ("include: a.yaml", {"a": "- 1"}, "a.yaml: found .*expected a mapping of sections"),
        ("include: a.yaml", {"a": ""}, "a.yaml: found nothing, expected a mapping of sections"),
        ("include: a.yaml", {"a": "x: &a [*a]"}, "a.yaml: found an alias within"),
        ("include: a.yaml", {"a": "x: [1"}, "a.yaml, line 1: found text that is not YAML"),
        ("include: a.yaml\nparameters: {m: 1}\n" + BODIES, {"a": "\n" + JOINTS.replace("end", "and")}, "line 3 of .*a.yaml, joints.pin.i: found 'bar.and'"),
        ("parts: {p: {include: q.yaml}}", {}, "line 1, parts.p.include: found no such file"),
        ("include: " + "x" * 5000, {}, "found no such file|cannot be read"),
    ],
)  # fmt: skip
def test_what_cannot_be_included_is_told_with_its_place(write, main, files, reason):
    with pytest.raises(InputError, match=reason) as told:
        stiffmbs.load_scene(write(main=main, **files))
    assert "\n" not in str(told.value)


def test_files_within_files_are_bounded(write):
    files = {f"f{k}": f"include: [f{k + 1}.yaml, f{k + 1}.yaml]" for k in range(12)}
    with pytest.raises(InputError, match="more than 100 files"):
        stiffmbs.load_scene(write(**files, f12="parameters: {}"))


def test_parts_include_their_definitions(write):
    path = write(
        main="parts: {p: {include: sub/p.yaml}}\nuse: {a: {part: p}}",
        sub__p="include: b.yaml",
        sub__b=BODIES.replace("m,", "1,"),
    )
    assert list(stiffmbs.load_scene(path).bodies) == ["a.bar"]
    write(sub__b=BODIES)
    with pytest.raises(
        InputError, match=r"line 2 of .*b.yaml, parts.p.bodies.bar.mass: found 'm', which is in m.*\(in a\)"
    ):
        stiffmbs.load_scene(path)


def _tyre(tmp_path, place):
    text = (ROOT / "examples" / "car.tir").read_text()
    (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / place).write_text(text)


STL = (
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"
)
WHEEL = """
bodies:
  wheel: {mass: 10, inertia: [1, 1, 1], geometry: [{type: mesh, file: shapes/wheel.stl}]}
  blade: {type: flexible, mesh: blade.vtu, units: {length: mm}, material: {E: 2e11, nu: 0.3, density: 7800}, modes: 2,
          interfaces: {root: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}}}
forces:
  tyre: {type: magic_formula_tyre, i: wheel, properties: ../tyres/car.tir, road: {type: grid, file: road.csv}}
"""
GRID = "-1, 1\n0, 0, 0\n1, 0.1, 0.1\n"


@pytest.fixture
def files(tmp_path):
    """Write a tyre, a road, a picture and a mesh next to the files that name them."""
    _tyre(tmp_path, "tyres/car.tir")
    for name, text in {
        "sub/shapes/wheel.stl": STL,
        "sub/road.csv": GRID,
        "track.csv": GRID.replace("0.1", "0.3"),
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    mesh_of_bar("hexahedron", 2, 1).write(tmp_path / "sub" / "blade.vtu")
    return tmp_path


@pytest.mark.parametrize(
    "main",
    [
        "dimensions: 3\ninclude: sub/wheel.yaml",
        "dimensions: 3\ninclude: sub/deep/through.yaml",
        "dimensions: 3\nparts: {p: {include: sub/wheel.yaml}}\nuse: {a: {part: p}}",
        "dimensions: 3\ninclude: sub/parts.yaml",
    ],
)
def test_names_of_files_start_from_the_folder_of_the_file_that_has_them(write, files, main):
    path = write(
        main=f"{main}\nroads: {{track: {{type: grid, file: track.csv}}}}",
        sub__wheel=WHEEL,
        sub__parts="parts: {p: {include: wheel.yaml}}\nuse: {a: {part: p}}",
        sub__deep__through="include: ../wheel.yaml",
    )
    scene = stiffmbs.load_scene(path)
    wheel, tyre = (
        next(x for name, x in s.items() if name.endswith(e))
        for s, e in ((scene.bodies, "wheel"), (scene.forces, "tyre"))
    )
    assert Path(wheel.geometry[0].file).read_text() == STL
    assert tyre.road.file.tables[0].table[-1][1] == 0.1
    assert any(name.endswith("blade.root") for name in scene.bodies)
    assert scene.roads["track"].file.tables[0].table[-1][1] == 0.3
    again = stiffmbs.load_scene(path, [(f"bodies.{next(n for n in scene.bodies if n.endswith('wheel'))}.mass", "11")])
    assert again.bodies.keys() == scene.bodies.keys()


def test_names_of_files_in_options_and_stages_of_included_files(write, files):
    path = write(
        main="dimensions: 3\ninclude: sub/all.yaml\n",
        sub__all="bodies: {wheel: {mass: 1, inertia: [1, 1, 1]}}\n"
        "options: {ground: {rough: {roads: {r: {type: grid, file: road.csv}}}}}\n"
        "forces: {tyre: {type: magic_formula_tyre, i: wheel, properties: ../tyres/car.tir, road: r}}\n"
        "stages: [{run: {duration: 1}}, {run: {duration: 1}, change: {forces: {tyre: {properties: ../tyres/car.tir}}}}]\n",
    )
    assert len(stiffmbs.load_scene(path).stage_scenes) == 2


def test_a_name_from_the_folder_of_the_scene_as_before_is_refused_with_the_new_one(write, files):
    text = WHEEL.replace("../tyres/car.tir", "tyres/car.tir")
    path = write(main="dimensions: 3\ninclude: sub/wheel.yaml", sub__wheel=text)
    with pytest.raises(
        InputError, match=r"wheel.yaml: found the file 'tyres/car.tir', expected '../tyres/car.tir': names of"
    ):
        stiffmbs.load_scene(path)


def test_absolute_names_stay_and_shared_entries_are_changed_once(write, files):
    tyre = "&t {type: magic_formula_tyre, i: a, properties: ../tyres/car.tir, road: {type: flat}}"
    path = write(
        main="dimensions: 3\ninclude: sub/all.yaml",
        sub__all="bodies: {a: &a {mass: 1, inertia: [1, 1, 1]}, b: *a}\n"
        f"forces: {{one: {tyre}, two: {{<<: *t, i: b}}, three: *t}}\nroads: {{r: {{type: grid, file: {files / 'track.csv'}}}}}",
    )
    scene = stiffmbs.load_scene(path)
    assert len(scene.forces) == 3
    assert scene.roads["r"].file.tables[0].table[-1][1] == 0.3


def test_all_fields_with_names_of_files_are_known():
    """A new field whose text is the name of a file belongs to `PLACES`."""
    known = {path[-1] for path in PLACES}
    assert set(_named(scene_schema())) - {"include"} == known


def _named(found):
    if isinstance(found, list):
        for part in found:
            yield from _named(part)
    if isinstance(found, dict):
        for key, value in found.get("properties", {}).items() if isinstance(found.get("properties"), dict) else ():
            described = json.dumps(value.get("description", "")) if isinstance(value, dict) else ""
            if re.search(
                r"file of (a mesh|K|M|the nodes|CalculiX)|a file \.|name of a\w* .*file|archive \(|files whose",
                described,
            ):
                yield key
        for value in found.values():
            yield from _named(value)
