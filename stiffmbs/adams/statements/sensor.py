"""Sensors, which end or change simulations.  MSC Adams/Solver, SENSOR statement."""

from __future__ import annotations

from dataclasses import dataclass

from ..functions.function import Function, read_function, required_function
from .arguments import Arguments, Numbered
from .text import Statement
from .units import Units

RELATIONS = {"EQ": "equals", "GE": "at_least", "LE": "at_most"}
ENDS = {"RETURN": "next", "HALT": "stop"}
RECORDS = ("PRINT", "DT", "EVALUATE")
"""Actions of a sensor that does not end the simulation."""
WITHOUT_EFFECT = ("CODGEN", "RESTART", "STEPSIZE", "YYDUMP", "BISECTION")
"""Integrator settings, which do not apply: integration restarts at a sensor in any case."""
USUAL_ERROR = 1e-3


@dataclass(frozen=True)
class Sensor(Numbered):
    """Monitored function, in the dataset's units.

    Attributes
    ----------
    relation : str
        ``equals``, ``at_least`` or ``at_most``.
    value, error : float
        Value to compare with, and tolerance.
    then : str
        ``next``: the next command follows; ``stop``: the simulation ends; ``on``: it continues with an
        output row there; empty: no effect.
    interval : float or None
        Output interval from then on.
    evaluated : Function or None
        Value of SENVAL from then on.
    left_out : tuple of str
        Arguments without effect.
    """

    function: Function
    relation: str
    value: float
    error: float
    then: str
    interval: float | None
    evaluated: Function | None
    left_out: tuple[str, ...]


def read_sensor(statement: Statement, units: Units) -> Sensor:
    """Read a sensor."""
    own = ("FUNCTION", "VALUE", "ERROR", "ANGULAR", "ROUTINE", "EVAL_ROUTINE")
    names = (*own[:4], *RELATIONS, *ENDS, *RECORDS, *WITHOUT_EFFECT, *own[4:])
    found = Arguments(statement, "SENSOR", names, ("FUNCTION", "EVALUATE"))
    value, error = found.number("VALUE"), found.number("ERROR")
    if value is None:
        raise found.fault("found no VALUE, expected the number that the function is compared with")
    if error is not None and error < 0:
        raise found.fault(f"found ERROR = {found.text('ERROR')}, expected no number below zero", found.line("ERROR"))
    relation = RELATIONS[found.one_of(*RELATIONS) or "EQ"]
    ends = found.one_of(*ENDS)
    interval = found.positive("DT")
    then = ENDS[ends] if ends else "on" if any(name in found for name in RECORDS) else ""
    return Sensor(
        *found.head(), required_function(found, "FUNCTION"), relation, value,
        USUAL_ERROR if error is None else error, then, interval, read_function(found, "EVALUATE"),
        tuple(name for name in WITHOUT_EFFECT if name in found),
    )  # fmt: skip
