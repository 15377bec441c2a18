"""Notes are strings that know their kind; every kind is on the page of the documentation, every check in a table."""

import copy
import json
import pickle
import re
import sys
from pathlib import Path

import pytest

import stiffmbs
from stiffmbs.analyses.checks import CHECKS, Integrated
from stiffmbs.analyses.job import prepare
from stiffmbs.notes import Note, NoteKind, Severity, note_lines, of_users
from stiffmbs.results.joined import joined
from stiffmbs.show.summary import as_json, summary
from stiffmbs.solve.reasons import Reason

from .conftest import EXAMPLES

HERE = Path(__file__).parents[1]
GROWS = "bodies: {b: {mass: 1, inertia: 1, position: [1, 0]}}\nforces: {f: {type: force, i: b, force: ['9*b.x', 0]}}\nrun: {duration: 8 s}"
STRETCHED = NoteKind("stretched", "'{element}' is stretched by {much:.2g} m", "correct {what}", Severity.DOUBT)


@pytest.fixture(scope="module")
def grown():
    return stiffmbs.run(stiffmbs.read_scene(GROWS))


def kinds():
    sys.path.insert(0, str(HERE / "docs" / "sphinx_plugins"))
    try:
        import note_kinds
    finally:
        del sys.path[0]
    return note_kinds


def test_a_note_is_its_sentence():
    note = STRETCHED("spring", much=0.1234, what="{a}")
    assert note == "'spring' is stretched by 0.12 m; correct {a}" and isinstance(note, str)
    assert (note.kind, note.element, note.remedy, note.severity) == (
        "stretched", "spring", "correct {a}", Severity.DOUBT,
    )  # fmt: skip
    assert json.loads(json.dumps([note])) == [str(note)] and {note: 1}[str(note)] == 1


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda note: pickle.loads(pickle.dumps(note))])
def test_a_copy_keeps_what_a_note_knows(copied):
    note = STRETCHED("spring", much=1.0, what="it")
    assert (copied(note), copied(note).as_dict()) == (note, note.as_dict())


def test_a_remedy_may_stand_within_the_text():
    assert NoteKind("k", "bad. {remedy}!", "Mend it")() == "bad. Mend it!"
    assert NoteKind("k", "bad", "{how}")(how="") == "bad"


def test_elements_with_one_note_share_it():
    first, second = of_users(
        [("a", "is odd"), ("b", STRETCHED("a", much=1.0, what="it")), ("c", "is odd"), ("a", "is odd")]
    )
    assert first == "a, c: is odd" and first.element == "a" and second.kind == "stretched"


def test_a_stored_solution_keeps_its_notes(grown, tmp_path):
    grown.save(tmp_path / "run.npz")
    loaded = stiffmbs.Solution.load(tmp_path / "run.npz")
    assert [(note, note.as_dict()) for note in loaded.notes] == [(note, note.as_dict()) for note in grown.notes]
    assert any(note.kind == "divergence" for note in loaded.notes)


def test_all_outputs_have_the_same_notes(grown):
    printed = json.loads(as_json("s", grown))
    assert printed["notes"] == list(grown.notes)
    assert [details["kind"] for details in printed["note_details"]] == [note.kind for note in grown.notes]
    lines = summary(grown)
    assert all(f"{k}. {note}" in lines for k, note in enumerate(grown.notes, 1))
    assert note_lines(grown.notes) == [f"note: {note}" for note in grown.notes]


def test_the_headline_has_the_first_doubt(grown):
    (doubt,) = (note for note in grown.notes if note.severity is Severity.DOUBT)
    assert doubt.element == "b" and doubt.partition(";")[0] in grown.message


def locked(**run):
    """A crank that is longer than its rod."""
    return stiffmbs.run(stiffmbs.load_scene(EXAMPLES / "crank_slider.yaml", [("r", "400 mm")]), **run)


def of_force(law, **run):
    return lambda: stiffmbs.run(stiffmbs.read_scene(GROWS.replace("'9*b.x'", law)), **run)


def left_table():
    scene = GROWS.replace("'9*b.x'", "'f(b.x)'") + "\ntables: {f: {table: [[0, 10], [1.5, 10]], beyond: error}}"
    return stiffmbs.run(stiffmbs.read_scene(scene))


@pytest.mark.parametrize(
    ("reason", "solve"),
    [
        ("LEFT_TABLE", left_table),
        ("LOCKED", lambda: locked(solver="kinematic")),
        ("NOT_FINITE", of_force("'1e14*b.x'", solver="projected", scheme="rk4", step=0.1)),
        ("STIFF", of_force("'-1e17*b.x - 1e8*b.vx'", solver="projected")),
        ("NO_STEP", of_force("'1/(1.5 - b.x)^2'")),
    ],
)
def test_the_end_of_a_run_has_its_reason(reason, solve, tmp_path):
    found = solve()
    assert not found.success, found.message
    expected = Reason[reason]
    assert (found.ended.kind, found.ended.remedy) == (expected.name.lower().replace("_", "-"), expected.remedy), (
        found.message
    )
    assert json.loads(as_json("s", found))["ended"]["kind"] == found.ended.kind
    found.save(tmp_path / "run.npz")
    assert stiffmbs.Solution.load(tmp_path / "run.npz").ended.as_dict() == found.ended.as_dict()


def test_a_completed_run_has_no_reason(grown):
    assert grown.ended == grown.message and grown.ended.kind == ""


def test_notes_of_joined_runs_keep_their_kinds(grown):
    calm = stiffmbs.run(stiffmbs.read_scene(GROWS), duration=0.1)
    found = joined("both", [calm, grown])
    (doubt,) = (note for note in found.notes if note.kind == "divergence")
    assert doubt.startswith("run 2: ") and isinstance(doubt, Note)


def test_checks_read_what_a_run_has():
    """Checks have names of their own, and ask for what a run may have."""
    job = prepare(stiffmbs.read_scene(GROWS))
    trajectory, structure = job.integrate(), type("Structure", (), {"of_joints": ()})
    run = Integrated(job, job.dynamics.system, trajectory, None, structure, (), None, (), None)
    assert len({check.name for check in CHECKS}) == len(CHECKS)
    assert not {check.name for check in CHECKS if check.has(run)} & {"functions", "assembly", "solver", "left tables"}


def test_kinds_are_named_once_and_described():
    found = kinds().note_kinds()
    names = [kind.name for kind in {id(kind): kind for kind in found.values()}.values()]
    assert len(names) > 80 and len(set(names)) == len(names)
    for where, kind in found.items():
        assert re.fullmatch(r"[a-z]+(-[a-z]+)*", kind.name), where
        text, remedy = kinds().words(kind)
        assert text and "{remedy}" not in text + remedy, where


def test_the_page_of_notes_lists_all_kinds():
    assert ".. note_kinds::" in (HERE / "docs" / "reference" / "notes.md").read_text(encoding="utf-8")
    text = "\n".join(kinds().page(found := kinds().note_kinds()))
    assert all(f"``{kind.name}``" in text for kind in found.values())
    assert all(reason.what in text and reason.remedy in text for reason in Reason)
