"""Whole processes: interrupted by the user, started at once on an empty cache, run for long."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest

import stiffmbs

COMMAND = [sys.executable, "-m", "stiffmbs", "run"]
TELLING = """
import sys
from stiffmbs.__main__ import start
from stiffmbs.commands.progress import ProgressBar

told = []

def tell(bar, t):
    if t > 1 and not told:
        told.append(t)
        print("under way", file=sys.stderr, flush=True)

ProgressBar.__call__ = tell
start()
"""
"""The command, which says on standard error when it has come beyond 1 s."""


def environment(cache):
    return {**os.environ, "STIFFMBS_CACHE": str(cache)}


def _heed_interrupts():
    """Children of a process that ignores interrupts, as those that run tests in parallel do, would ignore them too."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_interruption_keeps_what_was_computed(examples, tmp_path, solver):
    scene, results = examples / "cart_pendulum.yaml", tmp_path / "out.npz"
    stiffmbs.run(stiffmbs.load_scene(scene), duration=0.01, solver=solver)  # compiled before
    options = ["--duration", "100000", "--solver", solver, "--set", "run.output=0.1", "--json", "-o", str(results)]
    process = subprocess.Popen(
        [sys.executable, "-c", TELLING, "run", str(scene), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=_heed_interrupts,
    )
    assert process.stderr.readline() == b"under way\n"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    report = json.loads(out)
    assert (process.returncode, report["status"]) == (1, "interrupted"), err
    with np.load(results) as kept:
        assert len(kept["time"]) > 2
        assert report["time"]["end"] == kept["time"][-1] < 100_000
    assert b"Traceback" not in err


@pytest.mark.long
def test_two_first_runs_at_once_share_an_empty_cache(examples, tmp_path):
    command = [*COMMAND, str(examples / "cart_pendulum.yaml"), "--json"]
    together = [
        subprocess.Popen(command, stdout=subprocess.PIPE, cwd=tmp_path, env=environment(tmp_path / "cache"))
        for _ in range(2)
    ]
    reports = [json.loads(process.communicate(timeout=120)[0]) for process in together]
    again = json.loads(subprocess.run(command, capture_output=True, env=environment(tmp_path / "cache")).stdout)
    for report in reports:
        assert report["channels"] == again["channels"]
    assert not [path for path in (tmp_path / "cache").iterdir() if path.name.startswith(".")]


@pytest.mark.long
def test_a_thousand_seconds_of_the_pendulum_keep_to_the_constraints(examples):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    solution = stiffmbs.run(scene, duration=1000, points=2001, rtol=1e-8)
    assert solution["constraint.position"].max() < 1e-10
    assert solution.energy_drift() < 1e-2


ENDING = """
import atexit, sys
sys.argv[0] = "stiffmbs"
from stiffmbs import __main__
from stiffmbs.commands import main

def command():
    atexit.register(print, "registered later")
    print("printed")
    {end}

main.main = command
__main__.start()
"""


@pytest.mark.parametrize(("end", "status"), [("sys.exit(3)", 3), ("raise ValueError", 1)])
def test_the_command_ends_with_its_status_when_all_that_was_registered_has_run_and_is_printed(end, status):
    buffered = {**os.environ, "PYTHONUNBUFFERED": ""}
    done = subprocess.run([sys.executable, "-c", ENDING.format(end=end)], capture_output=True, text=True, env=buffered)
    assert (done.returncode, done.stdout) == (status, "printed\nregistered later\n"), done.stderr
