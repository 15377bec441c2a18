"""Text that is solved again and again: results are those of a run, and an error has its line."""

import threading
import time

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.live.requests import ANSWERS, Request
from stiffmbs.live.solver import LiveSolver, NeedsConsent, error_of, shown
from stiffmbs.live.worker import Worker
from stiffmbs.solve.trajectory import unwatched

from ..conftest import EXAMPLES

TEXT = (EXAMPLES / "cart_pendulum.yaml").read_text(encoding="utf-8")


@pytest.mark.long
@pytest.mark.parametrize("numbers", [{}, {"L": "0.8 m"}, {"L": "0.8 m", "start": "10 deg"}])
def test_results_are_those_of_a_run(numbers):
    solver = LiveSolver()
    solver.solve(TEXT, {"L": "0.5 m"}, unwatched)  # what is kept of it must not show
    found = solver.solve(TEXT, numbers, unwatched).solution
    expected = stiffmbs.run(stiffmbs.read_scene(TEXT, list(numbers.items())))
    np.testing.assert_allclose(found["rail.fy"], expected["rail.fy"], rtol=1e-6)


def test_a_number_of_a_force_in_the_text_is_taken_over():
    solver = LiveSolver()
    solver.solve(TEXT, {}, unwatched)
    other = TEXT.replace("270 N/m", "500 N/m")
    found = solver.solve(other, {}, unwatched).solution
    np.testing.assert_allclose(found["cart.x"], stiffmbs.run(stiffmbs.read_scene(other))["cart.x"], atol=1e-5)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (TEXT.replace("mass: 10 kg", "mass: ten"), 10),
        (TEXT.replace("type: revolute", "type: revolut"), 22),
        (TEXT.replace("gravity: [0, -9.81]", "gravity: [0, -9.81"), 8),
        (TEXT.replace("rtol: 1e-6", "rtoll: 1e-6"), 33),
    ],
)
def test_an_error_has_its_line(text, line):
    with pytest.raises(InputError) as error:
        LiveSolver().solve(text, {}, unwatched)
    assert abs(error_of(error.value, "scene")["line"] - line) <= 1


def test_only_chosen_channels_are_sent():
    found = shown(LiveSolver().solve(TEXT, {}, unwatched), ["cart.x"])
    from ..show.page.test_page_data import unpacked

    head, _ = unpacked(found["page"])
    assert [c["name"] for c in head["channels"]["columns"] if "start" in c] == ["cart.x"]
    assert {c["name"] for c in head["channels"]["columns"]} >= {"rail.fy", "bar.omega"}
    assert {one["name"]: one["text"] for one in found["parameters"]}["L"] == "0.6 m"


@pytest.mark.long
def test_python_functions_need_consent():
    model = stiffmbs.Model()
    model.add("a", stiffmbs.Body(mass=1, inertia=1))
    model.add("f", stiffmbs.PythonForce(i="a", of=("a.x",), function=lambda x: (-x[0], 0, 0)))
    solver = LiveSolver(model=model.data())
    with pytest.raises(NeedsConsent, match="f "):
        solver.solve("", {}, unwatched)
    solver.allow()
    assert solver.solve("", {}, unwatched).solution.outcome.name == "DONE"


SWEEP = {"parameter": "L", "low": 0.4, "high": 0.8, "count": 3, "unit": "m"}


def request(**content):
    return Request({"text": TEXT, **content}, LiveSolver(), unwatched, lambda progress: None)


@pytest.mark.long
def test_a_band_holds_the_curves_of_a_sweep():
    answer = ANSWERS["sweep"](request(**SWEEP, channels=["rail.fy"]))
    (band,) = answer["bands"]
    for length in ("0.4 m", "0.6 m", "0.8 m"):
        run = stiffmbs.run(stiffmbs.read_scene(TEXT, [("L", length)]))
        curve = np.interp(answer["time"], run.time, run["rail.fy"])
        assert (curve >= np.array(band["low"]) - 1e-3).all() and (curve <= np.array(band["high"]) + 1e-3).all()


@pytest.mark.parametrize(
    "content", [{"count": 1}, {"count": 1000}, {"count": "many"}, {"low": None}, {"high": float("nan")}]
)
def test_a_sweep_of_other_bounds_is_refused(content):
    with pytest.raises(InputError, match="expected a number"):
        ANSWERS["sweep"](request(**SWEEP | content))


@pytest.mark.parametrize("what", ["check", "modes", "verify"])
def test_analyses_answer_in_words(what):
    answer = ANSWERS[what](request())
    assert {"check": "2 degrees of freedom", "modes": "Hz", "verify": "positions to"}[what] in answer["text"]


@pytest.mark.parametrize("suffix", [".csv", ".npz", ".html"])
def test_results_are_exported(suffix):
    answer = ANSWERS["export"](request(suffix=suffix))
    assert len(answer["content"]) > 1000


LONG = TEXT.replace("duration: 10 s, output: 10 ms, rtol: 1e-6", "duration: 1e6 s, points: 100, rtol: 1e-9")


def answered(worker, answers, number, patience=60.0):
    end = time.monotonic() + patience
    while time.monotonic() < end:
        for answer in list(answers):
            if answer["number"] == number and answer["status"] != "progress":
                return answer
        time.sleep(0.01)
    raise AssertionError(f"no answer to {number}: {[a['status'] for a in answers]}")


@pytest.fixture
def worker():
    answers = []
    made = Worker(LiveSolver(), answers.append)
    thread = threading.Thread(target=made.loop, daemon=True)
    thread.start()
    yield made, answers
    made.take(None)
    thread.join(30)
    assert not thread.is_alive()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"what": "solve", "text": TEXT + "# \ud800"}, "unacceptable character #xd800"),
        ({"what": "draw", "text": TEXT}, "what: found 'draw', expected one of solve, check"),
        ({"what": ["solve"]}, "what: found '['solve']', expected one of solve"),
    ],
)
def test_a_request_without_an_answer_gets_one_sentence(content, said):
    answers = []
    made = Worker(LiveSolver(EXAMPLES / "cart_pendulum.yaml"), answers.append)
    threading.Thread(target=made.loop, daemon=True).start()
    made.take({"number": 1, **content})
    answer = answered(made, answers, 1)
    made.take(None)
    assert answer["status"] == "error" and said in answer["message"] and "please report" not in answer["message"]


def test_the_newest_request_interrupts_a_long_run(worker):
    made, answers = worker
    made.take({"number": 1, "what": "solve", "text": LONG})
    end = time.monotonic() + 60
    while not any(answer["status"] == "progress" for answer in answers) and time.monotonic() < end:
        time.sleep(0.01)
    made.take({"number": 2, "what": "solve", "text": TEXT})
    assert answered(worker, answers, 2)["status"] == "done"
    assert answered(worker, answers, 1)["status"] == "superseded"


def test_a_stopped_run_shows_what_it_has(worker):
    made, answers = worker
    made.take({"number": 1, "what": "solve", "text": LONG})
    end = time.monotonic() + 60
    while not any(answer["status"] == "progress" for answer in answers) and time.monotonic() < end:
        time.sleep(0.01)
    made.take({"what": "stop"})
    answer = answered(worker, answers, 1)
    assert answer["status"] == "interrupted" and answer["page"]


def edits(text, count, seed=0):
    """Random edits of a text: characters taken out, put in, and lines exchanged."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        k, n = rng.integers(len(text)), rng.integers(1, 6)
        match rng.integers(4):
            case 0:
                yield text[:k] + text[k + n :]
            case 1:
                yield text[:k] + "".join(rng.choice(list("{}[]:,-# \n\t0129eE.abk*&!%'\"\\\0é"), n)) + text[k:]
            case 2:
                lines = text.split("\n")
                a, b = rng.integers(len(lines), size=2)
                lines[a], lines[b] = lines[b], lines[a]
                yield "\n".join(lines)
            case 3:
                yield text[:k]


@pytest.mark.long
@pytest.mark.parametrize("count", [40, pytest.param(300, marks=pytest.mark.long)])
def test_random_edits_do_not_end_the_worker(worker, count):
    made, answers = worker
    short = TEXT.replace("duration: 10 s", "duration: 0.1 s")
    for number, text in enumerate(edits(short, count), start=1):
        made.take({"number": number, "what": "solve", "text": text})
        if number % 3:
            answered(worker, answers, number)
    made.take({"number": count + 1, "what": "solve", "text": short})
    assert answered(worker, answers, count + 1)["status"] == "done"
    assert not [answer for answer in answers if "please report" in answer.get("message", "")]


def test_a_band_is_in_the_units_of_the_scene():
    text = TEXT + "units: {force: kN}\n"
    content = {
        "text": text,
        "what": "sweep",
        "parameter": "L",
        "low": 0.5,
        "high": 0.7,
        "count": 2,
        "unit": "m",
        "channels": ["rail.fy"],
    }
    (band,) = ANSWERS["sweep"](Request(content, LiveSolver(), unwatched, lambda _: None))["bands"]
    assert 0.05 < max(band["high"]) < 1  # of some 100 N


def test_choices_are_those_of_the_options():
    options = "options:\n  load:\n    none: {}\n    heavy: {forces: {push: {type: force, i: bar, force: [0, -50 N]}}}\n"
    for chosen, text in (("none", ""), ("heavy", "choose: {load: heavy}\n")):
        found = shown(LiveSolver().solve(TEXT + options + text, {}, unwatched), [])
        assert found["choices"] == [{"name": "load", "words": ["none", "heavy"], "chosen": chosen}]
    assert shown(LiveSolver().solve(TEXT, {}, unwatched), [])["choices"] == []


def test_notes_to_check_are_counted_without_remarks():
    remark = TEXT + "notes: [a remark of the scene]\n"
    found = shown(LiveSolver().solve(remark, {}, unwatched), [])
    assert "a remark of the scene" in found["notes"]
    assert found["grave"] == sum(note.severity.name != "REMARK" for note in found["notes"]) < len(found["notes"])


def test_progress_has_the_span_of_the_run(worker):
    made, answers = worker
    made.take({"number": 1, "what": "solve", "text": LONG})
    end = time.monotonic() + 60
    while not (told := [one for one in answers if "time" in one]) and time.monotonic() < end:
        time.sleep(0.01)
    made.take({"number": 2, "what": "solve", "text": TEXT})
    whole = stiffmbs.read_scene(LONG).run.duration
    assert (told[0]["start"], told[0]["end"]) == (0.0, whole) and 0 < told[0]["time"] < whole
