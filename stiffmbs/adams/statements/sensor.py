"""Sensors, which end or change simulations.  MSC Adams/Solver, SENSOR statement."""

from __future__ import annotations

from dataclasses import dataclass

from ..functions.function import Function, read_function
from .arguments import Arguments
from .declared import Numbered, expression, read_by
from .units import Units

RELATIONS = {"EQ": "equals", "GE": "at_least", "LE": "at_most"}
ENDS = {"RETURN": "next", "HALT": "stop"}
RECORDS = ("PRINT", "DT", "EVALUATE")
"""Actions of a sensor that does not end the simulation."""
WITHOUT_EFFECT = ("CODGEN", "RESTART", "STEPSIZE", "YYDUMP", "BISECTION")
"""Integrator settings, which do not apply: integration restarts at a sensor in any case."""
USUAL_ERROR = 1e-3


def _error(found: Arguments, _: Units) -> float:
    error = found.number("ERROR")
    return USUAL_ERROR if error is None else error


def _then(found: Arguments, _: Units) -> str:
    ends = found.one_of(*ENDS)
    return ENDS[ends] if ends else "on" if any(name in found for name in RECORDS) else ""


@dataclass(frozen=True)
class Sensor(Numbered):
    """Monitored function, in the dataset's units."""

    function: Function = expression("FUNCTION")
    # value, error: value to compare with, and tolerance
    value: float = read_by(lambda found, _: found.number("VALUE") or 0.0, "VALUE")
    error: float = read_by(_error, "ERROR", "ANGULAR")
    # ``equals``, ``at_least`` or ``at_most``
    relation: str = read_by(lambda found, _: RELATIONS[found.one_of(*RELATIONS) or "EQ"], *RELATIONS)
    # ``next``: the next command follows; ``stop``: the simulation ends; ``on``: it continues with an output row there;
    # empty: no effect
    then: str = read_by(_then, *ENDS, "PRINT")
    interval: float | None = read_by(lambda found, _: found.positive("DT"), "DT")  # output interval from then on
    # value of SENVAL from then on
    evaluated: Function | None = read_by(
        lambda found, _: read_function(found, "EVALUATE"), "EVALUATE", expressions=True
    )
    # arguments without effect
    left_out: tuple[str, ...] = read_by(lambda found, _: tuple(name for name in WITHOUT_EFFECT if name in found))
    others = ("ROUTINE", "EVAL_ROUTINE")
    ignored = dict.fromkeys(WITHOUT_EFFECT, "no effect on results")

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse a sensor without a value, or with a negative tolerance."""
        if found.number("VALUE") is None:
            raise found.fault("found no VALUE, expected the number that the function is compared with")
        if (found.number("ERROR") or 0.0) < 0:
            raise found.fault(f"found ERROR = {found.text('ERROR')}, expected a number of zero or more", "ERROR")
