"""A cache that someone else wrote to, or that is damaged: never a crash, never another motion."""

import json
import os
import shutil
import subprocess
import sys

import pytest

from stiffmbs.cache import entries as kept
from stiffmbs.cache.ownership import NotOwnError, check_folder, read_own
from stiffmbs.compile.machine import compiler as machine

NAME, OTHER = f"kernel-{'0' * 40}", f"kernel-{'1' * 40}"
TWICE, THRICE = "def f(x):\n    return 2.0*x\n", "def f(x):\n    return 3.0*x\n"


@pytest.fixture
def directory(tmp_path, monkeypatch):
    monkeypatch.setenv(kept.DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    kept._tell.cache_clear()
    return tmp_path / "cache"


def value(source, x):
    machine.compiled_source.cache_clear()
    return machine.compiled_source(source, "f", "float64(float64)").call(x)


def test_an_entry_counts_in_its_own_place_alone(directory):
    kept.write(NAME, b"content")
    shutil.copy(kept.folder() / NAME, kept.folder() / OTHER)
    assert kept.read(NAME) == b"content"
    assert kept.read(OTHER) is None


def test_an_entry_of_another_user_s_secret_does_not_count(directory):
    kept.write(NAME, b"content")
    entry = (kept.folder() / NAME).read_bytes()
    (directory / kept.SECRET).unlink()
    kept.write(OTHER, b"content")
    (kept.folder() / NAME).write_bytes(entry)
    assert kept.read(NAME) is None


def test_the_secret_is_for_the_user_alone(directory, monkeypatch):
    before = os.umask(0)
    try:
        kept.write(NAME, b"content")
    finally:
        os.umask(before)
    secret = directory / kept.SECRET
    assert secret.stat().st_mode & 0o077 == 0
    assert directory.stat().st_mode & 0o077 == 0
    secret.chmod(0o644)
    assert kept.read(NAME) is None
    kept.write(NAME, b"content")
    assert secret.stat().st_mode & 0o077 == 0
    assert kept.read(NAME) == b"content"


def link(path):
    path.rename(path.with_name("elsewhere"))
    path.symlink_to("elsewhere")


def pipe(path):
    path.unlink()
    os.mkfifo(path)


def folder(path):
    path.unlink()
    path.mkdir()


UNSOUND = {
    "link": (link, "symbolic link"),
    "pipe": (pipe, "not a regular file"),
    "folder": (folder, "not a regular file"),
    "writable by others": (lambda path: path.chmod(0o666), "others may write it"),
}


@pytest.mark.parametrize(("change", "words"), UNSOUND.values(), ids=UNSOUND.keys())
def test_what_is_no_file_of_the_user_s_own_is_refused_with_a_note(directory, caplog, change, words):
    kept.write(NAME, b"content")
    change(kept.folder() / NAME)
    assert kept.read(NAME) is None
    assert words in caplog.text
    assert NAME in caplog.text
    kept.write(NAME, b"anew")


def test_files_and_folders_of_another_user_are_refused(directory, monkeypatch):
    kept.write(NAME, b"content")
    entry = kept.folder() / NAME
    monkeypatch.setattr(os, "geteuid", lambda: 4242)
    with pytest.raises(NotOwnError, match="belongs to the user"):
        read_own(entry)
    with pytest.raises(NotOwnError, match="belongs to the user"):
        check_folder(directory)
    assert kept.read(NAME) is None


@pytest.mark.parametrize("which", ["cache", "entries"])
def test_a_folder_that_others_may_write_is_refused_with_a_note(directory, caplog, which):
    kept.write(NAME, b"content")
    (directory if which == "cache" else kept.folder()).chmod(0o777)
    assert kept.read(NAME) is None
    assert "others may write to it (mode 777)" in caplog.text
    kept.write(NAME, b"anew")
    if which == "cache":  # kept in the user's own cache directory in its place
        assert kept.read(NAME) == b"anew"
        assert directory not in kept.folder().parents
        assert value(TWICE, 21.0) == 42.0


def test_a_sticky_folder_of_the_user_s_own_serves(directory):
    kept.write(NAME, b"content")
    directory.chmod(0o1777)
    assert kept.read(NAME) == b"content"


@pytest.mark.long
def test_code_of_another_function_or_garbage_under_a_right_code_is_compiled_anew(directory):
    assert value(TWICE, 21.0) == 42.0
    entries = {path.name for path in kept.folder().iterdir()}
    assert value(THRICE, 21.0) == 63.0
    name = next(path.name for path in kept.folder().iterdir() if path.name not in entries)
    twice = kept.read(*entries)
    script = (
        "import sys; from stiffmbs.compile.machine.compiler import compiled_source\n"
        f"print(compiled_source({THRICE!r}, 'f', 'float64(float64)').call(21.0))"
    )
    for content in (twice, b"garbage", b"", twice[: len(twice) // 2], b"\x7fELF" + os.urandom(500)):
        kept.write(name, content)
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        assert (done.returncode, done.stdout.strip()) == (0, "63.0"), done.stderr
        assert kept.read(name) != content


@pytest.mark.long
def test_a_run_on_a_cache_of_entries_in_each_other_s_places_gives_the_same_numbers(examples, directory, tmp_path):
    command = [
        sys.executable,
        "-m",
        "stiffmbs",
        "run",
        str(examples / "bar_pendulum.yaml"),
        "--duration",
        "0.1",
        "--json",
    ]
    first = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    entries = sorted(path for path in kept.folder().iterdir())
    contents = [entry.read_bytes() for entry in entries]
    for k, entry in enumerate(entries):
        entry.write_bytes(contents[k - 1])
        if k % 3 == 1:
            pipe(entry)
    again = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=100)
    assert again.returncode == 0, again.stderr
    assert json.loads(again.stdout)["channels"] == json.loads(first.stdout)["channels"]
    assert "not a regular file" in again.stderr
    assert "Traceback" not in again.stderr


def test_a_full_disk_costs_nothing_but_the_cache(directory, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert value(TWICE, 21.0) == 42.0
    assert list(kept.folder().iterdir()) == []
