"""Entries that are long unused are removed, of all kinds and versions; those in use stay."""

import multiprocessing
import os
import time

import pytest

from stiffmbs.cache import contents, entries

DAY = 86400.0


@pytest.fixture
def directory(tmp_path, monkeypatch):
    monkeypatch.setenv(entries.DIRECTORY_VARIABLE, str(tmp_path))
    return tmp_path


def entry(kind, k, age=0.0, size=100):
    """Write an entry that was last used some time ago, s."""
    name = entries.name_of(kind, str(k))
    entries.write(name, b"x" * size)
    used = time.time() - age
    os.utime(entries.folder() / name, (used, used))
    return name


def tended(directory):
    (directory / contents.TENDED).unlink(missing_ok=True)
    contents.tend(directory)


def test_unused_entries_of_all_kinds_are_removed_and_used_ones_stay(directory):
    old = [entry(kind, 0, 91 * DAY) for kind in contents.KINDS]
    used = [entry(kind, 1, 89 * DAY) for kind in contents.KINDS]
    assert entries.read(old[0]) is not None  # marks it as used
    tended(directory)
    assert sorted(os.listdir(entries.folder())) == sorted([old[0], *used])


def test_of_too_many_bytes_the_longest_unused_half_goes(directory, monkeypatch):
    names = [entry("body", k, 10 - k, size=1000 - entries.CODE_SIZE) for k in range(10)]
    monkeypatch.setattr(contents, "MOST_BYTES", 10_000)
    tended(directory)
    assert len(os.listdir(entries.folder())) == 10
    monkeypatch.setattr(contents, "MOST_BYTES", 9_999)
    tended(directory)
    assert sorted(os.listdir(entries.folder())) == sorted(names[-4:])


def test_entries_of_former_folders_and_unfinished_ones_are_removed_and_no_other_files(directory):
    entry("kernel", 0)
    former, of_the_user = directory / f"files-{'0' * 12}", directory / "files-of-mine"
    for folder in (former, of_the_user):
        folder.mkdir()
        (folder / f"scene-{'0' * 40}").write_bytes(b"x")
    part = entries.folder() / f"{contents.PART}x"
    foreign = (entries.folder() / "notes.txt", directory / "notes.txt", directory / ("0" * 40))
    for path in (part, *foreign):
        path.write_bytes(b"x")
    for age, stay in ((0.5, True), (2, True), (91, False)):
        for path in (
            former / f"scene-{'0' * 40}",
            *of_the_user.iterdir(),
            *foreign,
            *([part] if part.exists() else []),
        ):
            os.utime(path, (time.time() - age * DAY,) * 2)
        tended(directory)
        assert part.exists() == (age < 1)
        assert former.exists() == stay
        assert all(path.exists() for path in (*foreign, *of_the_user.iterdir()))


def test_a_second_write_within_a_minute_looks_through_nothing(directory, monkeypatch):
    entry("kernel", 0)
    monkeypatch.setattr(contents, "_folders", lambda _: pytest.fail("looked through"))
    entry("kernel", 1)
    os.utime(directory / contents.TENDED, (time.time() + 1e6,) * 2)  # of a clock that was wrong
    with pytest.raises(BaseException, match="looked through"):
        entry("kernel", 2)


def test_a_full_disk_loses_no_entry_and_leaves_no_part(directory, monkeypatch):
    name = entry("record", 0)

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    entries.write(name, b"other")
    entries.write(entries.name_of("record", "1"), b"other")
    assert entries.read(name) == b"x" * 100
    assert os.listdir(entries.folder()) == [name]


def write_and_evict(k):
    for turn in range(40):
        entries.write(entries.name_of("kernel", str((k, turn))), b"x" * 1000)
        (entries.cache_directory() / contents.TENDED).unlink(missing_ok=True)
        contents.tend(entries.cache_directory())


def limited(k):
    contents.MOST_BYTES = 20_000
    write_and_evict(k)


@pytest.mark.long
def test_processes_that_write_and_evict_at_once_end_well(directory):
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=limited, args=(k,)) for k in range(2)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert [writer.exitcode for writer in writers] == [0, 0]
    left = os.listdir(entries.folder())
    assert 0 < len(left) < 40 and all(entries.read(name) == b"x" * 1000 for name in left)
