"""Notes on a model, a run or its results: each is a sentence with a kind, an element, a remedy and a severity.

A kind of note is declared next to the code that writes it, and called with the values of its fields.  The page of all notes in
the documentation (`docs/reference/notes.md`) lists every kind of the package.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any


class Severity(Enum):
    """Meaning of a note for the results."""

    REMARK = "what the program did, or what a model contains; the results are not in question"
    WARNING = "results may be less accurate than the tolerance, or may not be those of the model that was meant"
    DOUBT = "results may be wrong; the message of the run says so, too"
    STOP = "the run ended early; the results up to there are kept"


@dataclass(frozen=True, eq=False, repr=False)
class Note(str):
    """A note: a string with what a program needs to handle it.

    - `text`: the sentence, which is also the value of the string.
    - `kind`: name of its kind; empty for sentences from a scene, a file or an earlier version.
    - `element`: element or channel concerned, or an empty string.
    - `remedy`: part of the sentence that says what to do, or an empty string.
    - `severity`: what it means for the results.
    """

    text: str
    kind: str = ""
    element: str = ""
    remedy: str = ""
    severity: Severity = Severity.REMARK

    def __new__(cls, text: str, *_: object, **__: object) -> Note:
        return super().__new__(cls, text)

    @classmethod
    def of(cls, sentence: str) -> Note:
        """Return a sentence as a note."""
        return sentence if isinstance(sentence, cls) else cls(sentence)

    def after(self, place: str, element: str = "") -> Note:
        """Return the note with a place in front of its text."""
        return replace(self, text=place + self, element=element or self.element)

    @classmethod
    def restored(cls, text: str, details: Mapping[str, str]) -> Note:
        """Return a note from its text and the result of `as_dict`."""
        return cls(text, **{**details, "severity": Severity[details["severity"]]})  # type: ignore[arg-type]

    def as_dict(self) -> dict[str, str]:
        """Return what is not in the text, for JSON."""
        return {"kind": self.kind, "element": self.element, "remedy": self.remedy, "severity": self.severity.name}


@dataclass(frozen=True)
class NoteKind:
    """Kind of note: its name, its text with fields in braces, what to do, and its severity.

    The remedy has fields, too. It follows the text after a semicolon, unless the text has a field ``{remedy}``.
    """

    name: str
    text: str
    remedy: str = ""
    severity: Severity = Severity.WARNING

    def __call__(self, element: str = "", **values: Any) -> Note:
        """Return a note about an element, from the values of the other fields."""
        values["element"] = element
        remedy = self.remedy.format(**values)
        text = self.text.format(remedy=remedy, **values)
        if remedy and "{remedy}" not in self.text:
            text = f"{text}; {remedy}"
        return Note(text, self.name, element, remedy, self.severity)


def note_lines(notes: Iterable[str]) -> list[str]:
    """Return the lines that commands print for notes."""
    return [f"note: {note}" for note in notes]


def of_users(notes: Iterable[tuple[str, str]]) -> Iterator[Note]:
    """Yield each of some notes once, after the names of all elements that have it, from pairs of both."""
    users: dict[str, dict[str, None]] = {}
    for name, note in notes:
        users.setdefault(note, {})[name] = None
    for note, names in users.items():
        listed = ", ".join(names)
        yield Note.of(note).after(f"{listed}: ", next(iter(names)).strip("'"))
