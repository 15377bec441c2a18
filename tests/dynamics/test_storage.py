"""Large results lie in files: the same numbers, little memory."""

import errno
import os
import subprocess
import sys

import numpy as np
import pytest

import stiffmbs
from stiffmbs import tuning
from stiffmbs.dynamics import storage
from stiffmbs.results.files import write


def test_large_arrays_lie_in_files_and_keep_what_they_hold():
    with tuning.in_use({"storage": {"largest_in_memory": 1000}}):
        small, large = storage.allocated(10, 2), storage.allocated(300, 4)
    large[:] = np.arange(1200.0).reshape(300, 4)
    storage.release(small, large, large[5:9, 1])
    np.testing.assert_array_equal(large, np.arange(1200.0).reshape(300, 4))


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="the system cannot reserve space")
def test_a_full_disk_is_told_before_anything_is_written(monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full)
    few = tuning.in_use({"storage": {"largest_in_memory": 1000}})
    with few, pytest.raises(stiffmbs.InputError, match="too little space"):
        storage.allocated(300, 4)


@pytest.mark.long
def test_results_in_files_are_those_in_memory(examples, tmp_path):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    cases = ({}, {"solver": "projected", "scheme": "dop853"})
    in_memory = [stiffmbs.run(scene, points=5003, **changes) for changes in cases]
    few = {"storage": {"largest_in_memory": 1000, "block": 700}}
    for changes, expected in zip(cases, in_memory, strict=True):
        found = stiffmbs.run(scene, points=5003, tuning=few, **changes)
        for name in expected:
            np.testing.assert_array_equal(found[name], expected[name], err_msg=name)
    with tuning.in_use(few):
        for ending in ("csv", "npz"):
            write(tmp_path / f"results.{ending}", found)
    table = np.genfromtxt(tmp_path / "results.csv", delimiter=",", names=True, deletechars="")
    column = {head.partition("_(")[0]: head for head in table.dtype.names}
    with np.load(tmp_path / "results.npz") as archive:
        for name in found:
            np.testing.assert_array_equal(archive[name], found[name])
            np.testing.assert_array_equal(table[column[name]], found[name])


@pytest.mark.long
def test_two_million_points_take_less_memory_than_their_rows():
    """The rows of one pinned bar would be 30 numbers each: 480 MB."""
    program = (
        "import pathlib, stiffmbs;"
        "peak = lambda: int(pathlib.Path('/proc/self/status').read_text().partition('VmHWM:')[2].split()[0]) / 1024;"
        "m = stiffmbs.Model(gravity=(0, -9.81)); b = m.add('bar', stiffmbs.Body(mass=1, inertia=0.1, position=(0.5, 0)));"
        "m.add('pin', stiffmbs.Revolute(i=b.at(-0.5, 0), j='ground'));"
        "stiffmbs.run(m, duration=1.0, points=11); before = peak();"
        "s = stiffmbs.run(m, duration=1.0, points=2_000_000);"
        "print(len(s.time), peak() - before)"
    )
    shown = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()
    assert int(shown[0]) == 2_000_000
    assert float(shown[1]) < 330
