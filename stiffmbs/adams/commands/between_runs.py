"""What may be changed between two simulations of a command file: what the state that is carried over does not hang on."""

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
"""Arguments that may be changed of statements which have others too; of statements that are not here, all."""


def refuse_between_runs(command: Statement, name: str) -> None:
    """Refuse a change that means another start, or another frame of what is known of it.

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
    """The argument that a piece of a command names; nothing for a further value of the one before it."""
    head = piece.text.partition("=")[0].strip().upper()
    return head if "=" in piece.text or head.isidentifier() else ""
