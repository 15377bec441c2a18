"""Drafts of compiled code: used at once, finished by another process, equal to the last bit."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses import run as runs
from stiffmbs.analyses.long_runs import Drafted, Predicted, TakesLongError
from stiffmbs.cache import entries
from stiffmbs.compile.machine import compiler, drafts, finish
from stiffmbs.compile.machine.routines import forget, fully_compiled, renew

SOURCE = (
    "def norm(n, x):\n    found = 0.0\n    for k in range(n):\n        found = found + x[k]*x[k]\n    return found\n"
)
SIGNATURE = "float64(int64, float64*)"
NUMBERS = np.random.default_rng(3).normal(size=1001)


@pytest.fixture
def started(tmp_path, monkeypatch):
    """Allow drafts in an empty cache, and count the processes that would finish them."""
    monkeypatch.setenv(entries.DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.delenv(drafts.VARIABLE)
    monkeypatch.setattr(drafts, "_used", set())
    found = []
    monkeypatch.setattr(drafts, "_start_finishing", lambda: found.append(1))
    drafts._can_be_finished.cache_clear()
    forget()
    yield found
    drafts._can_be_finished.cache_clear()
    forget()


def norm():
    return compiler.compiled_source(SOURCE, "norm", SIGNATURE)


def value(found):
    return found.call(len(NUMBERS), NUMBERS.ctypes.data)


def stored():
    return sorted(path.name.partition("-")[0] for path in entries.folder().iterdir())


def test_a_draft_is_finished_later_with_equal_results(started):
    first = norm()
    assert first.is_draft and stored() == ["draft"] and started == [1]
    renew()
    assert norm() is first  # until it is finished
    for name in list(finish._drafts()):
        finish.finish_draft(name)
    assert stored() == ["kernel"]
    renew()
    second = norm()
    assert not second.is_draft and second.address != first.address
    assert value(first) == value(second)
    assert started == [1] and not drafts.are_used()


def test_another_process_uses_the_draft_and_asks_for_its_end_again(started, monkeypatch):
    """The process that was to finish it may have been killed."""
    norm()
    forget()
    monkeypatch.setattr(drafts, "_used", set())
    monkeypatch.setattr(compiler, "_assembly", lambda *_: pytest.fail("translated again"))
    assert norm().is_draft and started == [1, 1]


def test_long_runs_and_times_of_runs_use_no_drafts(started, monkeypatch):
    first = norm()
    monkeypatch.setattr(compiler, "_assembly", lambda *_: pytest.fail("translated again"))
    with fully_compiled():
        second = norm()
        assert not second.is_draft and value(first) == value(second)
    assert stored() == ["kernel"]


@pytest.mark.parametrize("reason", ["variable", "batch", "cache"])
def test_where_no_process_may_be_started_nothing_is_a_draft(started, monkeypatch, reason):
    if reason == "cache":
        monkeypatch.setenv(entries.DIRECTORY_VARIABLE, "/dev/null/nowhere")
    else:
        monkeypatch.setenv(drafts.VARIABLE if reason == "variable" else "SLURM_JOB_ID", "0")
    assert not norm().is_draft and not started


def test_drafts_of_another_machine_are_left_to_it(started):
    norm()
    (name,) = finish._drafts()
    entries.write(name, drafts.draft_in(name)._replace(machine="another").packed())
    finish.finish_draft(name)
    assert stored() == ["draft"]


@pytest.mark.parametrize("content", [b"", b"[]\n", b'["kernel", "", 3, false, 3]\nabc', b"\xff"])
def test_drafts_of_another_form_are_removed(started, content):
    norm()
    (name,) = finish._drafts()
    entries.write(name, content)
    finish.finish_draft(name)
    assert stored() == []


def test_one_process_finishes_drafts_at_a_time(started, monkeypatch):
    norm()
    monkeypatch.setattr(os, "nice", lambda _: None)
    monkeypatch.setattr(finish, "PATIENCE", 0.01)
    path = entries.cache_directory() / finish.FINISHING
    with finish._alone(path):
        finish.finish()
    assert stored() == ["draft"]
    finish.finish()
    assert stored() == ["kernel"]


@pytest.mark.long
def test_the_process_finishes_all_drafts_and_ends_whatever_lies_in_the_current_folder(examples, tmp_path):
    for module in ("json", "zlib", "pickle", "llvmlite", "numpy", "stiffmbs", "subprocess"):
        (tmp_path / f"{module}.py").write_text(f"open({str(tmp_path / 'imported')!r}, 'a')\n")
    cache = tmp_path / "cache"
    kept = {name: text for name, text in os.environ.items() if name != drafts.VARIABLE}
    environment = {**kept, entries.DIRECTORY_VARIABLE: str(cache), "PYTHONSAFEPATH": "1"}
    run = [sys.executable, "-m", "stiffmbs", "run", str(examples / "cart_pendulum.yaml"), "--json"]
    first = subprocess.run(run, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    end = time.monotonic() + 300
    while names(cache, "draft") and time.monotonic() < end:
        time.sleep(0.5)
    assert not names(cache, "draft") and names(cache, "routine") and not (tmp_path / "imported").exists()
    while is_locked(cache / finish.FINISHING):
        assert time.monotonic() < end
        time.sleep(0.5)
    second = subprocess.run(run, capture_output=True, text=True, env=environment, cwd=tmp_path)
    without_time = [
        text.partition('"seconds"')[0] + text.partition('"channels"')[2] for text in (first.stdout, second.stdout)
    ]
    assert without_time[0] == without_time[1]


def names(cache, kind):
    return [path.name for path in (cache / "entries").iterdir() if path.name.startswith(f"{kind}-")]


def is_locked(path):
    try:
        with finish._alone(path):
            return False
    except OSError:
        return True


SOLVERS = [
    ("bdf", {}),
    ("radau", {}),
    ("projected", {"scheme": "dop853"}),
    ("auto", {}),
    ("bdf", {"formulation": "index1"}),
]


@pytest.mark.long
@pytest.mark.parametrize(
    "scene", ["half_car", "stick_slip", "heavy_top"]
)
@pytest.mark.parametrize(("solver", "settings"), SOLVERS)
def test_runs_on_drafts_are_equal_to_the_last_bit(started, examples, scene, solver, settings):
    model = stiffmbs.load_scene(examples / f"{scene}.yaml")
    duration = min(1.0, model.run.duration)
    first = stiffmbs.run(model, duration=duration, solver=solver, **settings)
    assert drafts.are_used()
    with fully_compiled():
        second = stiffmbs.run(model, duration=duration, solver=solver, **settings)
    assert first.channels.keys() == second.channels.keys()
    for channel in first.channels:
        np.testing.assert_array_equal(first[channel], second[channel], channel)


def is_long(monkeypatch, seconds, times, **parameters):
    """Tell whether a run over 2 s takes long that has reached some times after some seconds of processor time."""
    clock, seen = iter(seconds), []
    monkeypatch.setattr("time.process_time", lambda: next(clock))
    watch = Predicted(3.0, seen.append, Drafted(**parameters))
    try:
        for t in times:
            watch(t)
    except TakesLongError:
        return True
    finally:
        assert seen == list(times[: len(seen)])
    return False


@pytest.mark.parametrize(("seconds", "times", "expected"), [
    ((0, 0, 4.0), (1.0, 1.5), True),  # 12 s remain
    ((0, 0, 4.0), (1.0, 1.7), False),  # 7 s
    ((0, 0, 15.0), (1.0, 2.6), False),  # nearly done
    ((0, 0, 0.9), (1.0, 1.01), False),  # too early to tell
    ((0, 0, 1.1), (1.0, 1.01), True),
    ((0, 0, 8.0, 20.0, 20.0), (1.0, 2.9, 1.0), False),  # the second run begins
    ((0, 0, 8.0, 20.0, 20.0, 24.0), (1.0, 2.9, 1.0, 1.5), True),
])  # fmt: skip
def test_the_time_that_remains_decides(monkeypatch, seconds, times, expected):
    assert is_long(monkeypatch, seconds, times) == expected


def test_a_long_run_starts_again_on_fully_compiled_code(started, monkeypatch, examples):
    with fully_compiled():
        expected = stiffmbs.run(examples / "stick_slip.yaml", duration=2.0, solver="projected")
    for path in entries.folder().iterdir():
        path.unlink()
    forget()
    ended = []

    class Short(Predicted):
        def __init__(self, end, watch):
            super().__init__(end, watch, Drafted(patience=0.0, least=0.0))

        def __call__(self, t):
            try:
                super().__call__(t)
            except TakesLongError:
                ended.append(t)
                raise

    monkeypatch.setattr(runs, "Predicted", Short)
    found = stiffmbs.run(examples / "stick_slip.yaml", duration=2.0, solver="projected")
    assert len(ended) == 1 and not set(stored()) & {"draft"}
    for channel in expected.channels:
        np.testing.assert_array_equal(found[channel], expected[channel], channel)
