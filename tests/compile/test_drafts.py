"""Drafts of compiled code: used at once, finished by another process, equal to the last bit."""

import functools
import os
import shutil
import subprocess
import sys
import time
from zipfile import ZipFile

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses import run as runs
from stiffmbs.analyses.long_runs import Drafted, Predicted, TakesLongError
from stiffmbs.cache import entries, library
from stiffmbs.compile import record
from stiffmbs.compile.compile_model import kinds_of
from stiffmbs.compile.machine import compiler, drafts, finish, object_code
from stiffmbs.compile.machine.finishing import Finishing
from stiffmbs.compile.machine.routines import TERMS, compile_unit, forget, fully_compiled, on_drafts, renew, units
from stiffmbs.compile.symbolic import derive

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
    monkeypatch.setattr(drafts, "_used", {})
    found = []
    monkeypatch.setattr(drafts, "_start_finishing", lambda: found.append(1))
    drafts._can_be_finished.cache_clear()
    forget()
    with on_drafts():
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
    assert stored() == ["draft"] and started == [1]
    renew()
    assert norm() is first  # until it is finished
    for name in list(finish._drafts()):
        finish.finish_draft(name)
    assert stored() == ["kernel"]
    renew()
    second = norm()
    assert second.address != first.address
    assert value(first) == value(second)
    assert started == [1] and not drafts.quick_ones_are_used()


def test_another_process_uses_the_draft_and_asks_for_its_end_again(started, monkeypatch):
    """The process that was to finish it may have been killed."""
    norm()
    forget()
    monkeypatch.setattr(drafts, "_used", {})
    monkeypatch.setattr(compiler, "drafted", lambda *_: pytest.fail("translated again"))
    assert norm() and started == [1, 1]


def test_long_runs_and_times_of_runs_use_no_drafts(started, monkeypatch):
    first = norm()
    monkeypatch.setattr(compiler, "drafted", lambda *_: pytest.fail("translated again"))
    with fully_compiled():
        second = norm()
        assert second.address != first.address and value(first) == value(second)
    assert stored() == ["kernel"]


def test_times_of_runs_have_no_drafts_inside_either(started):
    with fully_compiled(), on_drafts():
        norm()
    assert stored() == ["kernel"] and not started


def test_studies_that_follow_a_run_use_no_drafts(started):
    """A study keeps what it has prepared, and would use drafts to its end."""
    first = norm()
    with drafts.down_to(drafts.Tier.LIBRARY):
        renew()
        assert norm().address != first.address
        assert stored() == ["kernel"]


@pytest.mark.parametrize("reason", ["variable", "batch", "cache"])
def test_where_no_process_may_be_started_nothing_is_a_draft(started, monkeypatch, reason):
    if reason == "cache":
        monkeypatch.setenv(entries.DIRECTORY_VARIABLE, "/dev/null/nowhere")
    else:
        monkeypatch.setenv(drafts.VARIABLE if reason == "variable" else "SLURM_JOB_ID", "0")
    assert value(norm()) and not started and not drafts.quick_ones_are_used()


def test_drafts_of_another_machine_or_version_are_left_to_it(started):
    norm()
    (name,) = finish._drafts()
    entries.write(name, drafts.draft_in(entries.read(name))._replace(origin="another").packed())
    finish.finish_draft(name)
    assert stored() == ["draft"]


def test_the_draft_of_another_function_is_not_taken(started):
    expected = value(norm())
    (name,) = finish._drafts()
    other = compiler.drafted(
        "kernel-other", compiler.of_source(SOURCE.replace("found +", "found -"), "norm", SIGNATURE)[1]
    )
    entries.write(name, other._replace(is_quick=True, symbols=name, code=b"garbage").packed())
    forget()
    assert value(norm()) == expected and drafts.draft_in(entries.read(name)).code != b"garbage"


@pytest.mark.parametrize("content", [b"", b"[]\n", b'["kernel", "", 3, false, 3]\nabc', b"\xff"])
def test_drafts_of_another_form_are_removed(started, content):
    norm()
    (name,) = finish._drafts()
    entries.write(name, content)
    finish.finish_draft(name)
    assert stored() == []


def test_one_process_finishes_drafts_at_a_time(started, monkeypatch):
    norm()
    at_once(monkeypatch)
    path = entries.cache_directory() / finish.FINISHING
    with finish.alone(path):
        finish.finish()
    assert stored() == ["draft"]
    finish.finish()
    assert stored() == ["kernel"]


def at_once(monkeypatch, *units):
    """Finish drafts without waiting for others, and then compile some units of routines."""
    entries.cache_directory().mkdir(exist_ok=True)
    monkeypatch.setattr(os, "nice", lambda _: None)
    monkeypatch.setattr(finish, "WAITS", finish.Finishing(patience=0.01, pause=0.0))
    monkeypatch.setattr(finish, "units", lambda: units)


def test_other_routines_are_compiled_when_no_draft_is_left(started, monkeypatch):
    at_once(monkeypatch, TERMS.unit)
    norm()
    finish.finish()
    assert stored() == ["kernel", "routine"]
    monkeypatch.setattr(compiler, "drafted", lambda *_: pytest.fail("translated again"))
    finish.finish()
    with fully_compiled():
        assert TERMS.address


@pytest.mark.parametrize("digest", ["_language", "_native"])
def test_no_routine_is_kept_whose_source_changes_while_it_is_compiled(started, monkeypatch, digest):
    """The functions in memory and the texts of the changed files may be mixed in its code."""
    at_once(monkeypatch, TERMS.unit, TERMS.unit)
    texts = iter(["before", "after"])
    changing = functools.cache(lambda *_: next(texts))
    monkeypatch.setattr(compiler, digest, changing)
    finish.finish()
    assert not entries.folder().exists() and next(texts, "") == ""


def test_compiling_ahead_ends_where_nothing_can_be_stored(started, monkeypatch):
    at_once(monkeypatch, TERMS.unit, TERMS.unit)
    tried = []
    monkeypatch.setattr(entries, "write", lambda name, _: tried.append(name))
    finish.finish()
    assert len(tried) == 1


@pytest.fixture
def library_of(started, tmp_path, monkeypatch):
    """Make a library with given entries the one of the package."""

    def write(contents):
        file = tmp_path / "library.zip"
        with ZipFile(file, "w") as archive:
            for name, content in contents.items():
                archive.writestr(name, content)
        monkeypatch.setattr(library, "FILE", file)
        return file

    return write


OF_NORM = compiler.of_source(SOURCE, "norm", SIGNATURE)
has_x86 = pytest.mark.skipif(not object_code.generic_machine(), reason="the library has code for x86-64-v3")


@has_x86
def test_code_of_the_library_is_used_at_once_and_compiled_for_this_processor_later(library_of, started, monkeypatch):
    library_of(dict([compiler.in_library(*OF_NORM)]))
    monkeypatch.setattr(compiler, "drafted", lambda *_: pytest.fail("translated again"))
    first = norm()
    assert started == [1] and stored() == ["draft"] and not drafts.quick_ones_are_used()
    for name in list(finish._drafts()):
        finish.finish_draft(name)
    renew()
    assert stored() == ["kernel"] and norm().address != first.address and value(norm()) == value(first)


@has_x86
def test_routines_of_the_library_are_not_compiled_ahead(library_of, started, monkeypatch):
    library_of(dict([compiler.in_library(*compiler.of_routines(*TERMS.unit, ""))]))
    monkeypatch.setattr(compiler, "drafted", lambda *_: pytest.fail("translated again"))
    at_once(monkeypatch, TERMS.unit)
    finish.finish()
    assert not entries.folder().exists()


@has_x86
def test_straight_code_of_the_library_is_not_compiled_again(library_of, started, monkeypatch):
    library_of(dict([compiler.in_library(*compiler.of_source(SOURCE, "norm", SIGNATURE, level=object_code.SHORT))]))
    monkeypatch.setattr(compiler, "drafted", lambda *_: pytest.fail("translated again"))
    assert value(compiler.compiled_source(SOURCE, "norm", SIGNATURE, level=object_code.SHORT))
    assert not started and not entries.folder().exists()


@has_x86
def test_code_of_the_library_is_used_where_no_process_may_be_started(library_of, started, monkeypatch):
    library_of(dict([compiler.in_library(*OF_NORM)]))
    monkeypatch.setenv("SLURM_JOB_ID", "1")
    monkeypatch.setattr(compiler, "drafted", lambda *_: pytest.fail("translated again"))
    assert value(norm()) and not started


@has_x86
@pytest.mark.parametrize("fault", ["content", "archive", "absent", "processor", "source"])
def test_other_libraries_are_ignored(library_of, started, monkeypatch, fault):
    name, content = compiler.in_library(*OF_NORM)
    file = library_of({name: content[: len(content) // 2] if fault == "content" else content})
    if fault == "archive":
        file.write_bytes(file.read_bytes()[:200])
    elif fault == "absent":
        monkeypatch.setattr(library, "FILE", file.parent / "none.zip")
    elif fault == "processor":
        monkeypatch.setattr(compiler, "generic_machine", lambda: "")
    elif fault == "source":
        monkeypatch.setattr(compiler, "_language", lambda: "changed")
    assert value(norm()) == pytest.approx(NUMBERS @ NUMBERS)
    assert drafts.quick_ones_are_used()


def test_records_of_the_library_need_no_derivation(library_of, examples, monkeypatch):
    kinds = kinds_of(stiffmbs.load_scene(examples / "half_car.yaml"))
    contents = {}
    for kind in kinds:
        contents |= {record._entry(kind): record.packed(record.record_of(kind))}
        contents |= {
            record._entry(kind, term_set): record.source_of(kind, term_set).encode()
            for term_set in record.RARE
            if record.source_of(kind, term_set)
        }
    expected = [record.record_of(kind) for kind in kinds]
    library_of(contents)
    for made_before in (record._record_of, record._terms, record.source_of):
        made_before.cache_clear()
    shutil.rmtree(entries.cache_directory())
    monkeypatch.setattr(derive, "derive", lambda kind: pytest.fail("derived again"))
    found = [record.record_of(kind) for kind in kinds]
    assert [record.packed(one) for one in found] == [record.packed(one) for one in expected]
    assert any(record.source_of(kind, term_set) for kind in kinds for term_set in record.RARE)


@pytest.mark.long
def test_the_process_finishes_all_drafts_and_ends_whatever_lies_in_the_current_folder(examples, tmp_path):
    for module in ("json", "zlib", "pickle", "llvmlite", "numpy", "stiffmbs", "subprocess"):
        (tmp_path / f"{module}.py").write_text(f"open({str(tmp_path / 'imported')!r}, 'a')\n")
    cache = tmp_path / "cache"
    copy_routines(cache, [unit for unit in units() if ".ida." not in unit[0]])
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


def copy_routines(cache, chosen):
    """Copy compiled routines from the cache of the tests to an empty one."""
    (cache / entries.ENTRIES).mkdir(mode=0o700, parents=True)
    for unit in chosen:
        compile_unit(unit)
        name = entries.name_of(*compiler.of_routines(*unit, "")[0], object_code.machine())
        shutil.copy(entries.folder() / name, cache / entries.ENTRIES / name)
    shutil.copy(entries.cache_directory() / entries.SECRET, cache / entries.SECRET)


def names(cache, kind):
    return [path.name for path in (cache / "entries").iterdir() if path.name.startswith(f"{kind}-")]


def is_locked(path):
    try:
        with finish.alone(path):
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


@pytest.mark.sampled(11)
@pytest.mark.long
@pytest.mark.parametrize("scene", ["half_car", "stick_slip", "heavy_top"])
@pytest.mark.parametrize(("solver", "settings"), SOLVERS)
def test_runs_on_drafts_are_equal_to_the_last_bit(started, examples, scene, solver, settings, monkeypatch):
    monkeypatch.setattr(drafts, "object_code", object_code.object_code)  # at the levels of a run, not of the tests
    model = stiffmbs.load_scene(examples / f"{scene}.yaml")
    duration = min(1.0, model.run.duration)
    first = stiffmbs.run(model, duration=duration, solver=solver, **settings)
    assert drafts.quick_ones_are_used()
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
    ((0, 4.0), (1.0, 1.5), True),  # 12 s remain
    ((0, 4.0), (1.0, 1.7), False),  # 7 s
    ((0, 15.0), (1.0, 2.6), False),  # nearly done
    ((0, 0.9), (1.0, 1.01), False),  # too early to tell
    ((0, 1.1), (1.0, 1.01), True),
    ((0, 8.0, 20.0), (1.0, 2.9, 1.0), False),  # the second run begins
    ((0, 8.0, 20.0, 24.0), (1.0, 2.9, 1.0, 1.5), True),
])  # fmt: skip
def test_the_time_that_remains_decides(monkeypatch, seconds, times, expected):
    assert is_long(monkeypatch, seconds, times) == expected


@pytest.mark.parametrize(("compiled_at", "expected"), [((), True), ((1.5,), False), ((1.6,), True)])
def test_time_in_which_code_is_compiled_does_not_count(monkeypatch, compiled_at, expected):
    """Four seconds go by from 1 s to 1.5 s, and no time from there to 1.6 s."""
    names = [str(t) for t in compiled_at]
    monkeypatch.setattr(drafts, "_used", {})
    clock = iter((0.0, 4.0, 4.0))
    monkeypatch.setattr("time.process_time", lambda: next(clock))
    watch = Predicted(3.0, lambda t: drafts._used.update(dict.fromkeys({name for name in names if name == str(t)})))
    is_given_up = False
    for t in (1.0, 1.5, 1.6):
        try:
            watch(t)
        except TakesLongError:
            is_given_up = True
            break
    assert is_given_up is expected


@pytest.mark.long
def test_a_long_run_starts_again_on_fully_compiled_code(started, monkeypatch, examples):
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
    with fully_compiled():
        expected = stiffmbs.run(examples / "stick_slip.yaml", duration=2.0, solver="projected")
    for channel in expected.channels:
        np.testing.assert_array_equal(found[channel], expected[channel], channel)


def test_code_that_cannot_be_stored_is_compiled_fully_and_once(started, monkeypatch):
    monkeypatch.setattr(entries, "_put", lambda *_: (_ for _ in ()).throw(OSError("no space")))
    first = norm()
    renew()
    assert norm() is first and not drafts.are_used() and not started


def test_a_draft_stays_until_its_code_is_stored(started, monkeypatch):
    norm()
    monkeypatch.setattr(entries, "_put", lambda *_: (_ for _ in ()).throw(OSError("no space")))
    finish.finish_draft(*finish._drafts())
    assert stored() == ["draft"]


@pytest.mark.parametrize("executable", ["", None, "/usr/bin/blender"])
def test_a_program_that_embeds_python_uses_no_drafts(started, monkeypatch, executable):
    monkeypatch.setattr(sys, "executable", executable)
    assert value(norm()) and stored() == ["kernel"] and not started


def test_the_process_is_started_again_after_it_has_ended_and_gives_no_warning(started, monkeypatch, recwarn):
    norm()
    process = Finishing([sys.executable, "-c", ""])
    monkeypatch.setattr(drafts, "_finishing", [process])
    process.begin = time.monotonic()
    drafts.use("another", True)
    process.wait()
    process.begin -= 2 * finish.WAITS.patience
    drafts.use("a third", True)
    assert started == [1, 1]
    Finishing([sys.executable, "-c", "input()"], stdin=subprocess.PIPE, stderr=subprocess.DEVNULL).__del__()
    assert not [one for one in recwarn if "still running" in str(one.message)]


def test_threads_may_see_at_once_that_drafts_are_finished(started, monkeypatch):
    norm()
    finish.finish_draft(*finish._drafts())
    exists = type(entries.folder()).exists

    def seen_by_another(path):
        drafts._used.clear()
        return exists(path)

    monkeypatch.setattr(type(entries.folder()), "exists", seen_by_another)
    assert drafts.some_are_finished()
