"""Cases that are judged by a text or by one number, for tables of variants."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

from stiffmbs.errors import StiffmbsError

from ..case import Case, Outcome, Verdict, measured, told

Answer = TypeVar("Answer")


def refused(name: str, what: str, action: Callable[[], object], *words: str) -> Case:
    """Return a case that must end in an error with these words."""

    def judge() -> Verdict:
        """Return the verdict on the error."""
        try:
            found = action()
        except StiffmbsError as refusal:
            return told(str(refusal), words)
        return Verdict(Outcome.WRONG, detail=f"not refused: {str(found)[:200]}")

    return Case(name, what, judge, Outcome.TOLD)


def said(name: str, what: str, text: Callable[[], str], *words: str, without: tuple[str, ...] = ()) -> Case:
    """Return a case whose text must have these words; without any, it must be without some others."""

    def judge() -> Verdict:
        """Return the verdict on the text."""
        found = text()
        false = [word for word in without if word in found]
        if false:
            return Verdict(Outcome.WRONG, detail=f"found {', '.join(map(repr, false))} in: {found}")
        return told(found, words) if words else Verdict(Outcome.RIGHT, detail=found)

    return Case(name, what, judge, Outcome.TOLD if words else Outcome.RIGHT)


def compared(name: str, what: str, difference: Callable[[], float], allowed: float) -> Case:
    """Return a case whose number, the difference from an independent result, must be within a bound."""
    return Case(name, what, lambda: measured(float(difference()), allowed))


def with_files(files: Mapping[str, str], action: Callable[[Path], Answer]) -> Answer:
    """Call an action with a temporary folder that holds some text files."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8", newline="")
        return action(folder)
