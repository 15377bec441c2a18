"""Statements of Adams/Solver: supported, ignored and refused, with the ignored arguments."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from . import bodies, constraints, contact, curves, elastic, forces, friction, outputs, sensor, systems
from .declared import Numbered
from .text import Statement

READERS: dict[str, type[Numbered]] = {
    "PART": bodies.Part,
    "POINT_MASS": bodies.PointMass,
    "MARKER": bodies.Marker,
    "JOINT": constraints.Joint,
    "JPRIM": constraints.Primitive,
    "GCON": constraints.GeneralConstraint,
    "MOTION": constraints.Motion,
    "COUPLER": constraints.Coupler,
    "GEAR": constraints.Gear,
    "SFORCE": forces.SingleForce,
    "VFORCE": forces.ForceAlone,
    "VTORQUE": forces.TorqueAlone,
    "GFORCE": forces.VectorForce,
    "SPRINGDAMPER": elastic.SpringDamper,
    "BUSHING": elastic.Bushing,
    "BEAM": elastic.Beam,
    "FIELD": elastic.Field,
    "REQUEST": outputs.Request,
    "VARIABLE": outputs.Variable,
    "SPLINE": outputs.Spline,
    "ARRAY": outputs.Array,
    "CONTACT": contact.Contact,
    "FRICTION": friction.JointFriction,
    "SENSOR": sensor.Sensor,
    "PINPUT": systems.Plant,
    "POUTPUT": systems.Plant,
    "CURVE": curves.SpaceCurve,
    "PTCV": curves.PointOnCurve,
    "CVCV": curves.CurveOnCurve,
    "DIFF": systems.Differential,
    "LSE": systems.LinearSystem,
    "TFSISO": systems.TransferFunction,
    "MATRIX": systems.Matrix,
}
"""Class of each numbered statement; UNITS and ACCGRAV have no number and are read separately."""

SINGLE = ("UNITS", "ACCGRAV")
LEFT_OUT = {
    "GRAPHICS": "graphics",
    "MATERIAL": "materials",
    **dict.fromkeys(("OUTPUT", "RESULTS", "LIST"), "output settings"),
    **dict.fromkeys(("MREQUEST", "FEMDATA"), "output"),
    **dict.fromkeys(("LINEAR", "INTEGRATOR", "DEBUG", "EQUILIBRIUM", "IC", "KINEMATICS"), "analysis settings"),
    **dict.fromkeys(("LSOLVER", "PREFERENCES", "PSTATE"), "analysis settings"),
    **dict.fromkeys(("STRING", "SURFACE"), "unused data"),
    "TITLE": "text",
}
"""Ignored statements (no mass, force or constraint), with their content."""
FLEXIBLE = ("FLEX_BODY", "FE_PART", "FE_NODE", "FE_LOAD", "NONLINEAR_BEAM", "MFORCE", "MODAL", "EXTERNAL_SYSTEM")
REFUSED = {
    **dict.fromkeys(FLEXIBLE, "flexible bodies of datasets are not supported"),
    **dict.fromkeys(("PTSF", "CVSF", "SFSF"), "constraints on surfaces are not supported"),
    "CLEARANCE": "distances between surfaces are not computed",
    "NFORCE": "fields between more than two markers are not supported",
    **dict.fromkeys(("UCON", "GSE"), "it needs a user subroutine"),
    "TIRE": "its law is in Adams/Tire; use a tyre of a scene, which reads property files (.tir)",
    "PFORCE": "this force is not supported",
    **dict.fromkeys(("DEACTIVATE", "ACTIVATE"), "it is a command, expected in a command file"),
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


LEFT_OUT_ARGUMENTS: Mapping[str, Mapping[str, str]] = {name: kind.ignored for name, kind in READERS.items()}
"""Ignored arguments of each statement, with the reason."""
TEXT = "text"
"""Reason of ignored arguments that are not reported."""
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
