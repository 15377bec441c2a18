"""Statements of Adams/Solver: supported, ignored and refused, with the ignored arguments."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from . import bodies, constraints, contact, curves, elastic, forces, friction, outputs, sensor, systems
from .constraints import WITHOUT_FRICTION
from .curves import WITHOUT_EFFECT as CURVE_STARTS
from .sensor import WITHOUT_EFFECT
from .text import Statement
from .units import Units

Reader = Callable[[Statement, Units], Any]

READERS: dict[str, Reader] = {
    "PART": bodies.read_part,
    "POINT_MASS": bodies.read_point_mass,
    "MARKER": bodies.read_marker,
    "JOINT": constraints.read_joint,
    "JPRIM": constraints.read_primitive,
    "GCON": constraints.read_general_constraint,
    "MOTION": constraints.read_motion,
    "COUPLER": constraints.read_coupler,
    "GEAR": constraints.read_gear,
    "SFORCE": forces.read_single_force,
    **{name: partial(forces.read_vector_force, keyword=name) for name in ("VFORCE", "VTORQUE", "GFORCE")},
    "SPRINGDAMPER": elastic.read_spring_damper,
    "BUSHING": elastic.read_bushing,
    "BEAM": elastic.read_beam,
    "FIELD": elastic.read_field,
    "REQUEST": outputs.read_request,
    "VARIABLE": outputs.read_variable,
    "SPLINE": outputs.read_spline,
    "ARRAY": outputs.read_array,
    "CONTACT": contact.read_contact,
    "FRICTION": friction.read_friction,
    "SENSOR": sensor.read_sensor,
    **{name: partial(systems.read_plant, keyword=name) for name in ("PINPUT", "POUTPUT")},
    "CURVE": curves.read_curve,
    "PTCV": curves.read_point_on_curve,
    "CVCV": curves.read_curve_on_curve,
    "DIFF": systems.read_differential,
    "LSE": systems.read_linear_system,
    "TFSISO": systems.read_transfer_function,
    "MATRIX": systems.read_matrix,
}
"""Reader of each numbered statement; UNITS and ACCGRAV have no number and are read separately."""

SINGLE = ("UNITS", "ACCGRAV")
LEFT_OUT = {
    "GRAPHICS": "graphics",
    "MATERIAL": "materials",
    **dict.fromkeys(("OUTPUT", "RESULTS", "LIST"), "output settings"),
    **dict.fromkeys(("MREQUEST", "FEMDATA"), "output"),
    **dict.fromkeys(("LINEAR", "INTEGRATOR", "DEBUG", "EQUILIBRIUM", "IC", "KINEMATICS"), "analysis settings"),
    **dict.fromkeys(("LSOLVER", "PREFERENCES", "PSTATE"), "analysis settings"),
    **dict.fromkeys(("STRING", "SURFACE"), "data that nothing here uses"),
    "TITLE": "text",
}
"""Ignored statements (no mass, force or constraint), with their content."""
FLEXIBLE = ("FLEX_BODY", "FE_PART", "FE_NODE", "FE_LOAD", "NONLINEAR_BEAM", "MFORCE", "MODAL", "EXTERNAL_SYSTEM")
REFUSED = {
    **dict.fromkeys(FLEXIBLE, "flexible bodies are not solved for"),
    **dict.fromkeys(("PTSF", "CVSF", "SFSF"), "curves and surfaces in space are not read"),
    "CLEARANCE": "distances between surfaces are not computed",
    "NFORCE": "fields between more than two markers are not read",
    **dict.fromkeys(("UCON", "GSE"), "it needs a user's own subroutine"),
    "TIRE": "tyres belong to Adams' own libraries; a scene has tyres of its own",
    "PFORCE": "it is none of the forces that are read",
    **dict.fromkeys(("DEACTIVATE", "ACTIVATE"), "it is a command, which belongs into a command file"),
}
"""Unsupported statements with mass, force, constraint or states, with the reason."""

_ALL = (*SINGLE, *READERS, *LEFT_OUT, *REFUSED)


def keyword(word: str) -> str | None:
    """Return the full name of a statement from an abbreviation of three letters or more; None if unknown."""
    if word in _ALL:
        return word
    if len(word) < 3:
        return None
    return next((name for name in _ALL if name.startswith(word)), None)


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
