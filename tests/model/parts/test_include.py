"""Scenes that include other files."""

import io
import sys

import pytest

import stiffmbs
from stiffmbs.errors import InputError

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
