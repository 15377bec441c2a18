"""Arguments that are known and have no effect here, and why, by statement."""

from __future__ import annotations

from collections.abc import Mapping

from .constraints import WITHOUT_FRICTION
from .curves import WITHOUT_EFFECT as CURVE_STARTS
from .sensor import WITHOUT_EFFECT

_NO_STATICS = "in statics states find their own equilibrium"
LEFT_OUT_ARGUMENTS: Mapping[str, Mapping[str, str]] = {
    "PART": {"MATERIAL": "masses are given", "EXACT": "assembly may move every part"},
    "POINT_MASS": {"EXACT": "assembly may move every part"},
    "JOINT": dict.fromkeys(WITHOUT_FRICTION, "of friction of old versions, which is off"),
    "REQUEST": {
        "COMMENT": "text", "TITLE": "text", "CUNITS": "text", "CLABELS": "text", "RESULTS_NAME": "text",
        "ROUTINE": "a user's own subroutine",
    },
    "SPLINE": {"BLOCK": "of a file", "CHANNEL": "of a file"},
    "FRICTION": {
        "MAX_STICTION_DEFORMATION": "the joint creeps below STICTION_TRANSITION_VELOCITY",
        "INACTIVE": "friction is zero in statics",
    },
    "CURVE": {"MINPAR": "of a subroutine", "MAXPAR": "of a subroutine"},
    "PTCV": dict.fromkeys(CURVE_STARTS, "parts start where they are drawn"),
    "SENSOR": dict.fromkeys(WITHOUT_EFFECT, "no effect on results"),
    "DIFF": {"STATIC_HOLD": _NO_STATICS},
    "LSE": {"STATIC_HOLD": _NO_STATICS},
    "TFSISO": {"STATIC_HOLD": _NO_STATICS},
    "MATRIX": {"NAME": "text", "UNITS": "text"},
}  # fmt: skip
"""Statements that are not here have none."""
