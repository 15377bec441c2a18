"""YAML files whose content is kept from the run before: the same scene, and never that of another text."""

import json

import pytest

import stiffmbs
from stiffmbs.cache import entries
from stiffmbs.cache.entries import DIRECTORY_VARIABLE
from stiffmbs.reading.files import read_before
from stiffmbs.reading.files.read_before import read_yaml_file

TEXT = "a: {b: [1, 2.5, 1e-3, true, null, 'x', .inf, -0.0], c: {}}\nd: &d [[], {e: f}]\ng: *d\n"


@pytest.fixture
def scene(tmp_path, monkeypatch):
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "scene.yaml"


@pytest.fixture
def reads(monkeypatch):
    found = []

    def counted(text, source):
        found.append(text)
        return read(text, source)

    read = read_before.read_yaml
    monkeypatch.setattr(read_before, "read_yaml", counted)
    return found


def test_a_file_is_read_once_and_its_content_comes_back_exactly(scene, reads):
    first, again = (read_yaml_file(TEXT, "scene", scene) for _ in range(2))
    assert repr(first) == repr(again)
    assert len(reads) == 1


def test_a_changed_file_is_read_anew_and_takes_the_place_of_the_old_one(scene, reads):
    for k in (1, 2, 1):
        assert read_yaml_file(f"a: {k}", "scene", scene) == {"a": k}
    assert len(reads) == 3
    assert len(list(entries.folder().iterdir())) == 1


@pytest.mark.parametrize("text", ["1: a", "a: 2026-11-21", "a: !!set {b}", "a: !!binary aGk="])
def test_what_json_would_change_is_read_each_time(scene, reads, text):
    first, again = (read_yaml_file(text, "scene", scene) for _ in range(2))
    assert first == again and type(first) is type(again)
    assert len(reads) == 2


def test_an_entry_that_someone_else_wrote_is_not_believed(scene, reads):
    read_yaml_file("a: 1", "scene", scene)
    (entry,) = entries.folder().iterdir()
    stored = entry.read_bytes()
    entry.write_bytes(stored.replace(json.dumps({"a": 1}).encode(), json.dumps({"a": 2}).encode()))
    assert entry.read_bytes() != stored
    assert read_yaml_file("a: 1", "scene", scene) == {"a": 1}


def test_a_fault_is_told_with_its_line_in_a_file_that_was_read_before(scene):
    scene.write_text("bodies:\n  a: {mass: 1, inertia: 1}\n  b: {mass: 1, inertia: -1}\n", encoding="utf-8")
    for _ in range(2):
        with pytest.raises(stiffmbs.InputError, match=r"line 3, bodies\.b\.inertia"):
            stiffmbs.load_scene(scene)


@pytest.mark.parametrize(
    "text", ["0.1", "-3", "0", "12.50", "007", "1_000", "1e-3", "+4", ".5", "5.", "-0", "123456789012345678"]
)
def test_numbers_are_read_as_in_a_file(text):
    alone, within = stiffmbs.reading.files.yaml_text.read_yaml(text, "x"), read_before.read_yaml(f"[{text}]", "x")[0]
    assert repr(alone) == repr(within)
