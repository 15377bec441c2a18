"""What a command file (.acf) asks for: simulations, and what it changes before them.  MSC Adams/Solver, commands.

A command that would change results and is not followed is refused, never left out.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from .changes import Changes, alters, key_of
from .fault import DatasetFault
from .keywords import keyword
from .simulations import STATICS, Simulation, read_simulation
from .text import Statement, commands

FOLLOWED = ("SIMULATE", "ACTIVATE", "DEACTIVATE")
ENDING = ("STOP", "EXIT")
HARMLESS = (
    "FILE", "OUTPUT", "PREFERENCES", "INFO", "SHOW", "RESULTS", "MODEL", "SAVE", "FSAVE", "LIST", "HELP", "EPLOT",
    "GRAPHICS", "TITLE", "MREQUEST", "DEBUG",
)  # fmt: skip
"""Commands that have no effect on the results."""
SETTINGS = ("INTEGRATOR", "EQUILIBRIUM", "KINEMATICS", "IC", "LSOLVER", "LINEAR")
"""Commands that say how Adams computes what it computes, which is left to this package."""
NAMED_FIRST = 2
"""How many first lines may answer the questions of Adams/Solver for the names of files."""


@dataclass(frozen=True)
class Commands:
    """What a command file asks for.

    Attributes
    ----------
    simulations : tuple of Simulation
        Over time, one after the other.
    from_equilibrium : int or None
        The line of the static simulation before them.
    changes : Changes
        Of the dataset, before them.
    notes : tuple of str
        What of it is left out, a sentence each.
    """

    simulations: tuple[Simulation, ...] = ()
    from_equilibrium: int | None = None
    changes: Changes = field(default_factory=Changes)
    notes: tuple[str, ...] = ()


def read_commands(text: str) -> Commands:
    """What a command file asks for.

    Raises
    ------
    DatasetFault
        When it cannot be read, or asks for what is not followed and changes results.
    """
    simulations: list[Simulation] = []
    changes = Changes()
    later: list[Statement] = []
    from_equilibrium: int | None = None
    left_out = []
    for command in commands(text):
        name = _full(command.word)
        if name in ENDING:
            break
        if name == "SIMULATE":
            simulation = read_simulation(command)
            _refuse_between(simulation, simulations, later)
            if simulation.over_time:
                simulations.append(simulation)
            elif simulation.kind == STATICS:
                from_equilibrium = simulation.line
        elif name in SETTINGS:
            left_out.append(f"{name} (line {command.line})")
        elif name in HARMLESS or _is_name_of_file(command, name):
            continue
        elif simulations:
            later.append(command)
        elif from_equilibrium is not None:
            raise _fault(
                command, "found it after SIMULATE/STATICS, expected it before: changes between runs are not followed"
            )
        else:
            changes = _followed(changes, command, name)
    notes = (f"{', '.join(left_out)} of the command file left out: analysis settings",) if left_out else ()
    return Commands(tuple(simulations), from_equilibrium, changes, notes)


def _full(word: str) -> str | None:
    """The full name of a command, which an abbreviation of three letters or more stands for."""
    names = (*FOLLOWED, *ENDING, *HARMLESS, *SETTINGS)
    if word in names:
        return word
    short = next((name for name in names if name.startswith(word)), None) if len(word) > 2 else None
    return short if short in (*FOLLOWED, *ENDING) else keyword(word) or short


def _is_name_of_file(command: Statement, name: str | None) -> bool:
    """Whether a line names the model or the results, before the first command."""
    return (
        name is None
        and command.line <= NAMED_FIRST
        and not command.ident
        and all("=" not in p.text for p in command.pieces)
    )


def _followed(changes: Changes, command: Statement, name: str | None) -> Changes:
    """The changes with those of a command."""
    if name in ("ACTIVATE", "DEACTIVATE"):
        return changes.switched(command, name == "ACTIVATE")
    if alters(name):
        return changes.with_arguments(command)
    raise _fault(
        command,
        f"found a command that is not followed, expected SIMULATE, ACTIVATE, DEACTIVATE, STOP, new values of statements, "
        f"or one of {', '.join((*HARMLESS, *SETTINGS))}, which are left out",
    )


def _refuse_between(simulation: Simulation, before: list[Simulation], changed: list[Statement]) -> None:
    """Refuse what would need a run of its own after the first one."""
    if before and changed:
        names = ", ".join(f"{_label(command)} (line {command.line})" for command in changed)
        raise simulation.fault(f"found {names} between two simulations, expected changes before the first one alone")
    if before and not simulation.over_time:
        raise simulation.fault(f"found {simulation.kind} after a simulation over time, expected it before")


def _label(command: Statement) -> str:
    name, ident = key_of(command)
    return f"{name}/{ident or command.ident}".rstrip("/")


def _fault(command: Statement, reason: str) -> DatasetFault:
    return DatasetFault(command.line, _label(command), reason)
