"""What a run tells while it is at work: in a terminal, by Python's logging, and nowhere else."""

import logging
import os
import pty
import re
import subprocess
import sys

import pytest

import stiffmbs
from stiffmbs.commands.progress import ProgressBar

IMPATIENT = """
from stiffmbs.__main__ import start
from stiffmbs.commands import progress

progress.SHOWN_AFTER = progress.BETWEEN_UPDATES = 0.0
start()
"""
"""The command, which shows runs as if they had gone on for long."""


def in_a_terminal(arguments, tmp_path, cache=None, program=("-m", "stiffmbs")):
    """What a command writes on a standard error that is a terminal."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "150"} | ({"STIFFMBS_CACHE": str(cache)} if cache else {})
    process = subprocess.Popen(
        [sys.executable, *program, *map(str, arguments)],
        stdout=subprocess.DEVNULL, stderr=theirs, cwd=tmp_path, env=environment,
    )  # fmt: skip
    os.close(theirs)
    shown = b""
    try:
        while part := os.read(ours, 65536):
            shown += part
    except OSError:  # the terminal's other side is closed
        pass
    os.close(ours)
    assert process.wait(timeout=60) == 0
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown.decode())


@pytest.mark.long
def test_a_first_run_in_a_terminal_shows_what_it_derives_and_compiles(examples, tmp_path):
    shown = in_a_terminal(["run", examples / "bar_pendulum.yaml", "--json"], tmp_path, tmp_path / "cache")
    assert re.search(r"deriving revolute \(1 of 2 kinds\)", shown)
    assert re.search(r"compiling (the routines \w+|\w+ \([12] of 2 kinds, \w+\))", shown)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", pytest.param("projected", marks=pytest.mark.long)])
def test_a_long_run_in_a_terminal_shows_time_step_order_and_time_left(examples, tmp_path, solver):
    asked = ["run", examples / "cart_pendulum.yaml", "--json", "--solver", solver, "--set", "run.output=0.1"]
    asked += ["--duration", "1000"]
    shown = in_a_terminal(asked, tmp_path, program=("-c", IMPATIENT))
    assert re.search(r"solving .*t = [\d.]+ s, step [\d.e-]+ s" + (", order [1-5]" if solver == "bdf" else ""), shown)
    assert re.search(r"[\d-]:[\d-]+ left", shown)
    assert in_a_terminal([*asked, "-q"], tmp_path, program=("-c", IMPATIENT)) == ""


@pytest.mark.long
def test_a_short_run_in_a_terminal_shows_nothing(examples, tmp_path):
    stiffmbs.run(examples / "bar_pendulum.yaml", duration=0.01)  # compiled before
    assert in_a_terminal(["run", examples / "bar_pendulum.yaml", "--json", "--duration", "0.01"], tmp_path) == ""


def test_nothing_is_listened_to_where_nobody_sees_it(monkeypatch, capsys):
    logger = logging.getLogger("stiffmbs")
    before = logger.level, list(logger.handlers)
    with ProgressBar(0.0, 1.0):
        assert (logger.level, list(logger.handlers)) == before
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with ProgressBar(0.0, 1.0):
        assert logger.isEnabledFor(logging.DEBUG)
    assert (logger.level, list(logger.handlers)) == before


def test_stages_and_steps_are_told_to_who_listens(examples, caplog):
    with caplog.at_level(logging.DEBUG, logger="stiffmbs"):
        solution = stiffmbs.run(examples / "cart_pendulum.yaml", duration=2.0)
    told = [record.getMessage() for record in caplog.records]
    assert "assembling Cart-pendulum" in told
    assert "solving Cart-pendulum by bdf" in told
    steps = [record for record in caplog.records if hasattr(record, "step")]
    assert steps[-1].getMessage().startswith("t = 2 s, step ")
    assert steps[-1].order == solution.solver["order"]
    assert steps[-1].step == pytest.approx(solution.history.t[-1] - solution.history.t[-2])


def test_two_kinds_with_the_same_kernel_share_it_whatever_is_told_of_them():
    from stiffmbs.compile.machine.compiler import Description

    assert Description("revolute (1 of 2 kinds)") == Description("weight")
    assert len({Description("one"), Description("another")}) == 1
