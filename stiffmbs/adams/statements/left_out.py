"""Ignored arguments by statement, with reasons, and ignored systems."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from .constraints import WITHOUT_FRICTION
from .curves import WITHOUT_EFFECT as CURVE_STARTS
from .sensor import WITHOUT_EFFECT
from .text import Statement

TEXT = "text"
_NO_STATICS = "in statics states find their own equilibrium"
LEFT_OUT_ARGUMENTS: Mapping[str, Mapping[str, str]] = {
    "PART": {"MATERIAL": "masses are given", "EXACT": "assembly may move every part"},
    "POINT_MASS": {"EXACT": "assembly may move every part"},
    "JOINT": dict.fromkeys(WITHOUT_FRICTION, "of friction of old versions, which is off"),
    "REQUEST": {
        "COMMENT": TEXT, "TITLE": TEXT, "CUNITS": TEXT, "CLABELS": TEXT, "RESULTS_NAME": TEXT,
        "ROUTINE": "a user's own subroutine",
    },
    "SPLINE": {"BLOCK": "of a file", "CHANNEL": "of a file"},
    "FRICTION": {
        "MAX_STICTION_DEFORMATION": "the joint creeps below STICTION_TRANSITION_VELOCITY",
        "INACTIVE": "friction is zero in statics", "INACTIVE_DURING": "friction is zero in statics",
    },
    "CURVE": {"MINPAR": "of a subroutine", "MAXPAR": "of a subroutine"},
    "PTCV": dict.fromkeys(CURVE_STARTS, "parts start where they are drawn"),
    "SENSOR": dict.fromkeys(WITHOUT_EFFECT, "no effect on results"),
    "DIFF": {"STATIC_HOLD": _NO_STATICS},
    "LSE": {"STATIC_HOLD": _NO_STATICS},
    "TFSISO": {"STATIC_HOLD": _NO_STATICS},
    "MATRIX": {"NAME": TEXT, "UNITS": TEXT},
}  # fmt: skip
"""Ignored arguments of each statement, with the reason."""
UNREAD_SYSTEM = "its equations are in a subroutine, and no function reads its states or outputs"
_ARRAY = re.compile(r"\s*(?:X|XD|Y)\s*=\s*(\d+)\s*", re.IGNORECASE)


def is_unread_system(name: str | None, statement: Statement, every: Sequence[Statement]) -> bool:
    """Return True for a GSE if no function reads its arrays X, XD or Y.

    `name`: full name of the statement. `every`: all statements of the dataset.
    """
    if name != "GSE":
        return False
    arrays = [found[1] for piece in statement.pieces if (found := _ARRAY.fullmatch(piece.text))]
    reads = re.compile(rf"\b(?:ARYVAL\s*\(\s*(?:{'|'.join(arrays) or 'no'})\b|USER\s*\()", re.IGNORECASE)
    return not any(reads.search(piece.text) for other in every for piece in other.pieces if other is not statement)
