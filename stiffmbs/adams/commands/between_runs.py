"""Dataset changes that are allowed between two simulations of a command file."""

from __future__ import annotations

from ..statements.changes import key_of
from ..statements.fault import DatasetFault
from ..statements.text import Statement, Subsystem

CHANGED = {
    "PART": ("MASS", "IP"),
    "POINT_MASS": ("MASS",),
    "MARKER": ("QP", "REULER", "XP", "ZP", "USEXP"),
    "JOINT": ("I", "J", "PITCH", "PD"),
    "MOTION": ("FUNCTION", "DISPLACEMENT", "VELOCITY"),
}
"""Arguments that may be changed, by statement; of statements not listed here, all arguments may be changed."""


def refuse_between_runs(command: Statement, name: str) -> None:
    """Refuse a change that would need other initial conditions or redefine the state carried over.

    Raises
    ------
    DatasetFault
    """
    allowed = CHANGED.get(name)
    if allowed is None:
        return
    words = [_word(piece) for piece in command.pieces]
    for word in filter(None, words):
        if not any(full.startswith(word) for full in allowed):
            _, ident = key_of(command)
            raise DatasetFault(
                command.line,
                f"{name}/{ident}",
                f"found {word} changed between two simulations, expected one of {', '.join(allowed)}: others belong to the "
                "start of the first",
            )


def _word(piece: Subsystem) -> str:
    """Return the argument named by a piece of a command; '' for a further value of the argument before it."""
    head = piece.text.partition("=")[0].strip().upper()
    return head if "=" in piece.text or head.isidentifier() else ""
