"""Stores that are damaged, or on a disk that is full: a sentence, or the same table; never other numbers."""

import random
import sqlite3

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, sweep
from stiffmbs.errors import SolverError
from stiffmbs.studies import store as kept

BALL = """
bodies: {b: {mass: 1, inertia: 1, velocity: [1, 0]}}
forces: {pull: {type: force, i: b, force: [-b.x, 0]}}
run: {duration: 0.1, points: 3}
"""


def study(folder, **more):
    return sweep(
        folder / "scene.yaml", {"bodies.b.mass": [1.0, 2.0, 3.0]}, outputs=["final(b.x)", "b.vx"], store=folder / "rows", **more
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene.yaml").write_text(BALL)
    study(tmp_path)
    return tmp_path


def changed(*statements):
    def change(path):
        connection = sqlite3.connect(path)
        for statement in statements:
            connection.execute(statement)
        connection.commit()
        connection.execute("pragma wal_checkpoint(truncate)")
        connection.close()

    return change


def cut(part):
    return lambda path: path.write_bytes(path.read_bytes()[: int(len(path.read_bytes()) * part)])


def filled(start, length, byte=b"\0"):
    def change(path):
        content = bytearray(path.read_bytes())
        content[start : start + length] = byte * len(content[start : start + length])
        path.write_bytes(content)

    return change


DAMAGES = {
    "empty": lambda path: path.write_bytes(b""),
    "text": lambda path: path.write_text("no table at all " * 100),
    "head alone": cut(0.01), "half": cut(0.5), "most": cut(0.95),
    "no head": filled(0, 100), "second page": filled(4096, 4096), "third page": filled(8192, 4096, b"\xff"), "all but the head": filled(100, 10**6),
    "no rows": changed("drop table rows"), "no parts": changed("drop table parts"), "no files": changed("drop table files"),
    "other columns": changed("drop table rows", "create table rows (number integer, x text)"),
    "another number": changed("update rows set outputs = zeroblob(32) where number = 1"),
    "another status": changed("update rows set status = 'done!' where number = 1"),
    "another case": changed("update rows set number = 17 where number = 1"),
    "text for numbers": changed("update rows set outputs = 'abc', lengths = 'def'"),
    "nothing for numbers": changed("update rows set outputs = x'', lengths = x''"),
    "no code": changed("update rows set code = x''"), "a null": changed("update parts set digest = x'00'"),
    "half a number": changed("update rows set outputs = substr(outputs, 1, 5) where number = 0"),
    "another format": changed("pragma user_version = 1"), "no study": changed("delete from parts"),
    "names of another kind": changed("insert into files values (x'ff', 'a')"), "a folder": lambda path: (path.unlink(), path.mkdir()),
    "another store": changed("create table other (x)", "pragma user_version = 99"),
}  # fmt: skip


@pytest.mark.sampled(3)
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_store_is_refused_or_mended(folder, damage):
    expected = sweep(folder / "scene.yaml", {"bodies.b.mass": [1.0, 2.0, 3.0]}, outputs=["final(b.x)", "b.vx"])
    DAMAGES[damage](folder / "rows")
    try:
        found = study(folder)
    except InputError as refusal:
        assert "rows: " in str(refusal)
        assert "\n" not in str(refusal)
    else:
        assert found.identical(expected)


@pytest.mark.parametrize(
    "seed",
    [*range(10), *(pytest.param(seed, marks=(pytest.mark.long, pytest.mark.sampled(9))) for seed in range(10, 100))],
)
def test_bits_that_have_changed_change_no_number(folder, seed):
    expected = sweep(folder / "scene.yaml", {"bodies.b.mass": [1.0, 2.0, 3.0]}, outputs=["final(b.x)", "b.vx"])
    chance = random.Random(seed)
    content = bytearray((folder / "rows").read_bytes())
    used = [k for k, byte in enumerate(content) if byte]
    for k in chance.sample(used, chance.choice((1, 1, 3, 30))):
        content[k] ^= 1 << chance.randrange(8)
    (folder / "rows").write_bytes(content)
    try:
        found = study(folder)
    except (InputError, SolverError) as refusal:
        assert "\n" not in str(refusal)
    else:
        assert found.identical(expected)


@pytest.mark.parametrize("full_from", range(4))
def test_a_full_disk_loses_no_row(tmp_path, monkeypatch, caplog, full_from):
    """Writing fails from some case on; the table is whole, and a note tells that rows were not kept."""
    (tmp_path / "scene.yaml").write_text(BALL)
    expected = sweep(tmp_path / "scene.yaml", {"bodies.b.mass": [1.0, 2.0, 3.0]}, outputs=["final(b.x)", "b.vx"])
    packed, calls = kept._packed, []

    def full(row):
        calls.append(row)
        if len(calls) > full_from:
            raise sqlite3.OperationalError("database or disk is full")
        return packed(row)

    monkeypatch.setattr(kept, "_packed", full)
    found = study(tmp_path)
    assert found.identical(expected)
    assert ("rows could not be stored" in caplog.text) == (full_from < 3)
    monkeypatch.setattr(kept, "_packed", packed)
    assert study(tmp_path).identical(expected)


def test_a_disk_that_is_full_for_a_while_keeps_all_rows(tmp_path, monkeypatch, caplog):
    (tmp_path / "scene.yaml").write_text(BALL)
    packed, calls = kept._packed, []

    def full(row):
        calls.append(row)
        if len(calls) < 3:
            raise sqlite3.OperationalError("database or disk is full")
        return packed(row)

    monkeypatch.setattr(kept, "_packed", full)
    study(tmp_path)
    assert not caplog.text
    seen = []
    study(tmp_path, watch=lambda *now: seen.append(now))
    assert not seen


def test_models_with_python_functions_have_no_store(tmp_path):
    made = stiffmbs.Model()
    made.add("b", stiffmbs.Body(mass=1, inertia=1))
    made.add("pull", stiffmbs.PythonForce(i="b", of=("b.x",), function=lambda x: (-x[0], 0, 0)))
    with pytest.raises(InputError, match="a scene file cannot hold a Python function"):
        sweep(made, {"bodies.b.mass": np.array([1.0, 2.0])}, store=tmp_path / "rows")
