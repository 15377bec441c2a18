"""How a dataset is to be run, from the command file (.acf) beside it.  MSC Adams/Solver, SIMULATE command."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from .arguments import Arguments
from .text import Statement, Subsystem, commands
from .units import Units

KINDS = ("DYNAMICS", "KINEMATICS", "TRANSIENT", "STATICS", "INITIAL_CONDITIONS")
OVER_TIME = ("DYNAMICS", "TRANSIENT", "KINEMATICS")
HARMLESS = ("FILE", "OUTPUT", "STOP", "PREFERENCES", "INFO", "SHOW", "RESULTS", "MODEL")
"""Commands that have no effect on the results."""


@dataclass(frozen=True)
class Commands:
    """What a command file asks for.

    Attributes
    ----------
    run : mapping of str to value
        Settings of the scene's run.
    notes : tuple of str
        What of it is left out, a sentence each.
    """

    run: dict[str, Any]
    notes: tuple[str, ...]


def read_commands(text: str, units: Units) -> Commands:
    """The first simulation over time that a command file asks for.

    Raises
    ------
    DatasetFault
        When it cannot be read.
    """
    run: dict[str, Any] = {}
    left_out = []
    for command in commands(text):
        simulated = (
            _simulation(command, units) if "SIMULATE".startswith(command.word) and len(command.word) > 2 else None
        )
        if simulated and not run:
            run = simulated
        elif not any(name.startswith(command.word) for name in HARMLESS) or simulated:
            left_out.append(f"{command.word} (line {command.line})")
    return Commands(run, (f"{', '.join(left_out)} of the command file left out",) if left_out else ())


def _simulation(command: Statement, units: Units) -> dict[str, Any] | None:
    """The settings of a simulation over time; nothing for others."""
    kind = (Subsystem(command.ident, command.line),) if command.ident else ()
    command = replace(command, ident="", pieces=(*kind, *command.pieces))
    found = Arguments(command, "SIMULATE", (*KINDS, "END", "DURATION", "STEPS", "DTOUT"))
    analysis = found.one_of(*KINDS) or "TRANSIENT"
    name = found.one_of("END", "DURATION")
    if analysis not in OVER_TIME or name is None:
        return None
    settings: dict[str, Any] = {"duration": (found.number(name) or 0.0) * units.time}
    steps, interval = found.number("STEPS"), found.number("DTOUT")
    if interval:
        settings["output"] = interval * units.time
    elif steps:
        settings["points"] = round(steps) + 1
    return settings | ({"solver": "kinematic"} if analysis == "KINEMATICS" else {})
