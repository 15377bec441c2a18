"""Finding of a report: the largest load of a run and its reliability in words, and the notes by their effect on the result."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..notes import Note, Severity
from ..results.digits import KnownErrors, over_time
from ..results.solution import Solution
from .loads import Column, Load
from .verdict import Verdict

LEAST_DIGITS = 2
"""Number of digits of forces below which loads are not called reliable."""
FEW_DIGITS = "Error bars of forces are large: set a smaller relative tolerance in the scene, such as run: {rtol: 1e-8}."
FEW_INSTANTS = "Error bars of forces are large as peaks lie between the output times: use a smaller output interval, or points: steps."
MARKS = {
    "doubt": "! In doubt",
    "stopped": "\N{MULTIPLICATION SIGN} Stopped",
    "interrupted": "\N{MULTIPLICATION SIGN} Interrupted",
}
MEANINGS = {
    Severity.STOP: "ends the run", Severity.DOUBT: "the result may be wrong", Severity.WARNING: "may affect the result",
    Severity.REMARK: "changes nothing",
}  # fmt: skip
"""Meaning of a note for the result by its severity, the gravest first."""


@dataclass(frozen=True)
class Finding:
    """Finding of a run."""

    status: str  # that of the `Verdict`; ``doubt`` also if notes or error bars put its loads in question
    mark: str
    sentence: str
    further: tuple[str, ...]


@dataclass(frozen=True)
class NoteRow:
    """Note as a row of a table."""

    meaning: str
    text: str
    remedy: str


def finding(judged: Verdict, solution: Solution, loads: Sequence[Load]) -> Finding:
    """Return the finding: the largest load with its place and error, and what is in question."""
    grave = [note for note in solution.notes if note.severity is not Severity.REMARK]
    digits = judged.digits.get("forces")
    status, mark = judged.status, MARKS.get(judged.status, "")
    if status == "done":
        if grave or (digits is not None and digits < LEAST_DIGITS):
            status, mark = "doubt", "! To be checked"
        else:
            mark = "\N{CHECK MARK} Completed" if digits is None else "\N{CHECK MARK} Reliable"
    sentence = _largest(loads) if judged.status == "done" else f"{judged.headline}."
    few = (_few(solution),) if digits is not None and digits < LEAST_DIGITS else ()
    return Finding(status, mark, sentence, (_digits(judged), *few, *_in_question(solution.notes, grave)))


def _few(solution: Solution) -> str:
    """Return what to do for more digits of forces: a smaller tolerance, unless they are known at the output times."""
    at_instants = KnownErrors(solution).digits(over_time).get("forces", 0)
    return FEW_INSTANTS if at_instants >= LEAST_DIGITS else FEW_DIGITS


def _largest(loads: Sequence[Load]) -> str:
    """Return a sentence on the largest force, or the largest torque without forces."""
    if not loads:
        return "No element carries a force or torque."
    load = loads[0]
    column = Column.of(load.unit, load.peak, load.display)
    what = "force" if load.unit == "N" else "torque"
    peak, unit = column.words(load.peak, load.bar), column.unit
    return f"The largest {what} is {peak} {unit}, in {load.element} at {load.time[load.peak_row]:.4g} s."


def _digits(judged: Verdict) -> str:
    if not judged.digits:
        return "Not verified: the errors of the computation are unknown. Run the scene with --verify."
    (first, count), *others = judged.digits.items()
    others_words = "".join(f", {name} to {number}" for name, number in others)
    return f"{first.capitalize()} are known to {count} digit{'s' if count != 1 else ''}{others_words}."


def _in_question(notes: Sequence[Note], grave: Sequence[Note]) -> Iterator[str]:
    if grave:
        text = note_rows(grave)[0].text
        yield f"{text[0].upper()}{text[1:]}."
        yield f"{len(grave)} of the {len(notes)} notes below may affect the result."
    elif notes:
        yield f"{len(notes)} note{'s' if len(notes) > 1 else ''} below, without an effect on the result."


def note_rows(notes: Sequence[Note]) -> list[NoteRow]:
    """Return notes as rows, the gravest first."""
    return [
        NoteRow(MEANINGS[note.severity], note.text.removesuffix(f"; {note.remedy}"), note.remedy or _nothing(note))
        for note in sorted(notes, key=lambda note: [*MEANINGS].index(note.severity))
    ]


def _nothing(note: Note) -> str:
    return "Nothing to do." if note.severity is Severity.REMARK else ""
