"""Scenes that are kept as they were once valid: the same scene, and never that of other texts, files or readers."""

import pickle
import shutil
from pathlib import Path

import pytest

import stiffmbs
from stiffmbs.cache import entries
from stiffmbs.cache.entries import DIRECTORY_VARIABLE
from stiffmbs.elements.own_elements import REGISTRY
from stiffmbs.model import read_scene as reading
from stiffmbs.model.files import scenes_read_before

EXAMPLES = Path(__file__).parents[2] / "examples"
TEXT = """
parameters: {L: 0.6 m}
variables: {swing: 3 N*sin(4 rad/s*t)}
bodies:
  bar: {mass: 2, inertia: 0.1, markers: {end: {point: [-L/2, 0]}}}
joints:
  hinge: {type: revolute, i: bar.end, j: ground}
forces:
  push: {type: force, i: bar, force: [2*swing, -5*bar.vy]}
"""


@pytest.fixture
def scene(tmp_path, monkeypatch):
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    path = tmp_path / "scene.yaml"
    path.write_text(TEXT)
    return path


@pytest.fixture
def reads(monkeypatch):
    """The sources that are read, in their order."""
    found = []

    def counted(text, changes, source, *others):
        found.append(source)
        return read(text, changes, source, *others)

    read = reading.read_scene
    monkeypatch.setattr(reading, "read_scene", counted)
    return found


def _kept():
    return [entry for entry in entries.folder().iterdir() if entry.name.startswith("scene-")]


@pytest.mark.parametrize("example", ["cart_pendulum", "half_car", "car", "governor", "vehicles/leaf_sprung_car"])
def test_a_scene_is_read_once_and_comes_back_as_it_was(scene, reads, example):
    first, again = (stiffmbs.load_scene(EXAMPLES / f"{example}.yaml") for _ in range(2))
    assert len(reads) == 1
    assert first is not again
    assert first == again
    assert repr(first) == repr(again)
    assert again.written.content == first.written.content
    assert again.written_parameters() == first.written_parameters()
    assert again.validated.scene is again  # so that a changed copy is told from it
    assert again.validated.context.keys() == first.validated.context.keys()


def test_it_has_the_same_motion(scene):
    first, again = (stiffmbs.run(stiffmbs.load_scene(scene), duration=0.5) for _ in range(2))
    assert all((first[name] == again[name]).all() for name in first.channels)


def test_another_text_is_read_anew_and_takes_the_place_of_the_old_one(scene, reads):
    for mass in (2, 3, 2):
        scene.write_text(TEXT.replace("mass: 2", f"mass: {mass}"))
        assert stiffmbs.load_scene(scene).bodies["bar"].mass == mass
    assert len(reads) == 3
    assert len(_kept()) == 1


def test_each_change_has_an_entry_of_its_own(scene, reads):
    for mass in ("3", "4", "3"):
        assert stiffmbs.load_scene(scene, [("bodies.bar.mass", mass)]).bodies["bar"].mass == float(mass)
    assert stiffmbs.load_scene(scene).bodies["bar"].mass == 2
    assert len(reads) == 3


def test_a_change_that_is_no_text_is_not_kept(scene, reads):
    for _ in range(2):
        assert stiffmbs.load_scene(scene, [("bodies.bar.mass", 3.0)]).bodies["bar"].mass == 3
    assert len(reads) == 2
    assert not _kept()


def test_a_file_that_is_included_is_looked_at_each_time(scene, reads):
    scene.write_text(TEXT + "include: more.yaml\n")
    more = scene.with_name("more.yaml")
    for stiffness in (1, 1, 2):
        more.write_text(f"gravity: [0, -{stiffness}]")
        assert stiffmbs.load_scene(scene).gravity == (0, -stiffness)
    assert len(reads) == 2
    more.unlink()
    with pytest.raises(stiffmbs.InputError, match="no such file"):
        stiffmbs.load_scene(scene)


@pytest.mark.long
def test_a_property_file_is_looked_at_each_time(scene, reads):
    for name in ("car.yaml", "car.tir"):
        shutil.copy(EXAMPLES / name, scene.parent)
    car, tyre = scene.with_name("car.yaml"), scene.with_name("car.tir")
    first, again = (stiffmbs.load_scene(car) for _ in range(2))
    assert first == again
    tyre.write_text(tyre.read_text() + "$ another file\n[SCALING_COEFFICIENTS]\nLMUX = 0.5\n")
    assert stiffmbs.load_scene(car) != first
    assert len(reads) == 2
    tyre.unlink()
    with pytest.raises(stiffmbs.InputError, match="no such file"):
        stiffmbs.load_scene(car)


def test_a_scene_in_stages_looks_at_what_its_stages_read(scene, reads):
    scene.write_text(TEXT + "include: more.yaml\nstages: [{run: {duration: 1}}, {run: {duration: 2}}]\n")
    for k in (1, 1, 2):
        scene.with_name("more.yaml").write_text(f"gravity: [0, -{k}]")
        assert [stage.gravity for stage in stiffmbs.load_scene(scene).stage_scenes] == [(0, -k)] * 2
    assert len(reads) == 2


def test_another_reader_reads_it_anew(scene, reads, monkeypatch):
    stiffmbs.load_scene(scene)
    monkeypatch.setattr(scenes_read_before, "_reader", lambda: "another")
    stiffmbs.load_scene(scene)
    assert len(reads) == 2


def test_a_scene_with_a_users_own_element_is_not_kept(scene, reads):
    @stiffmbs.register
    class Level(stiffmbs.Joint):
        kind = "level"
        equations = ("height",)
        i: stiffmbs.Marker

        @staticmethod
        def position(e):
            return [e.i.point[1]]

    try:
        scene.write_text(TEXT.replace("joints:\n", "joints:\n  level: {type: level, i: bar}\n"))
        for _ in range(2):
            assert type(stiffmbs.load_scene(scene).joints["level"]) is Level
    finally:
        REGISTRY.remove(Level)
    assert len(reads) == 2
    assert not _kept()


def test_a_large_scene_is_not_kept(scene, monkeypatch):
    monkeypatch.setattr(scenes_read_before, "MOST_ELEMENTS", 2)
    stiffmbs.load_scene(scene)
    assert not _kept()


def test_a_fault_is_told_with_its_line_each_time(scene):
    stiffmbs.load_scene(scene)
    scene.write_text(TEXT.replace("mass: 2", "mass: -2"))
    for _ in range(2):
        with pytest.raises(
            stiffmbs.InputError, match=r"scene.yaml, line 5, bodies.bar.mass: found '-2'|line 5, bodies.bar.mass"
        ):
            stiffmbs.load_scene(scene)


def test_an_entry_whose_classes_are_gone_is_made_anew(scene, reads, monkeypatch):
    stiffmbs.load_scene(scene)
    monkeypatch.setattr(
        scenes_read_before.pickle, "loads", lambda content: (_ for _ in ()).throw(AttributeError("gone"))
    )
    assert stiffmbs.load_scene(scene).bodies["bar"].mass == 2
    assert len(reads) == 2


@pytest.mark.parametrize(
    "garbage",
    [b"", b"\n", b"null\n", b"[1, 2]\n", b"{}\n\x80", b"\xff\xfe\n", b"[1, 2, 3]\nabc", "half", "no scene", "no head", "head alone", "other files"],
)  # fmt: skip
def test_garbage_with_a_right_code_is_made_anew(scene, reads, garbage):
    stiffmbs.load_scene(scene)
    for entry in _kept():
        whole = entries.read(entry.name)
        head, _, content = whole.partition(b"\n")
        made = {
            "half": whole[: len(whole) // 2], "no scene": head + b"\n" + pickle.dumps([1]), "no head": content,
            "head alone": head, "other files": head.replace(b"{}", b'[["a", 1]]') + b"\n" + content,
        }  # fmt: skip
        entries.write(entry.name, made.get(garbage, garbage))
    assert stiffmbs.load_scene(scene).bodies["bar"].mass == 2
    assert len(reads) == 2


@pytest.mark.parametrize("garbage", [b"", b"[", b"\xff", b'{"bodies":'])
def test_garbage_in_the_entry_of_a_text_is_read_anew(scene, garbage):
    stiffmbs.load_scene(scene)
    for entry in entries.folder().iterdir():
        if entry.name.startswith("file-"):
            entries.write(entry.name, entries.read(entry.name)[:40] + garbage)
        else:
            entry.unlink()
    assert stiffmbs.load_scene(scene).bodies["bar"].mass == 2
