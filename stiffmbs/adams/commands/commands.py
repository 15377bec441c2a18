"""Reader of Adams/Solver command files (.acf): simulations, and the dataset changes before each.

A command that would change results and is not supported is refused, never ignored.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from ...model.settings import DEFAULT_RTOL
from ..statements.arguments import Arguments
from ..statements.changes import Changes, Key, alters, key_of
from ..statements.keywords import keyword
from ..statements.text import DatasetFault, Statement, Subsystem
from .command_files import Read, all_commands, with_first_argument
from .simulations import Simulation, read_simulation

FOLLOWED = ("SIMULATE", "ACTIVATE", "DEACTIVATE", "INTEGRATOR", "LINEAR")
ENDING = ("STOP", "EXIT")
HARMLESS = (
    "FILE", "OUTPUT", "PREFERENCES", "INFO", "SHOW", "RESULTS", "MODEL", "SAVE", "FSAVE", "LIST", "HELP", "EPLOT",
    "GRAPHICS", "TITLE", "MREQUEST", "DEBUG",
)  # fmt: skip
"""Commands that have no effect on the results."""
SETTINGS = ("EQUILIBRIUM", "KINEMATICS", "IC", "LSOLVER", "ENVIRONMENT")
"""Analysis settings of Adams, which do not apply to this package."""
LINEAR = (
    "EIGENSOL", "STATEMAT", "MKB", "EXPORT", "FILE", "FORMAT", "KEEP", "NODAMPIN", "DAMPING", "ORIGINAL", "COORDS",
    "PSTATE", "PINPUT", "POUTPUT", "RM", "ENERGY", "DISSIPATION", "KINETIC", "STRAIN", "TABLE_PRECISION",
)  # fmt: skip
METHODS = (
    "GSTIFF", "WSTIFF", "CONSTANT_BDF", "HASTIFF", "HHT", "NEWMARK", "ABAM", "RKF45", "DSTIFF", "SI2", "SI1", "I3",
)  # fmt: skip
NUMBERS = ("ERROR", "HMAX", "HMIN", "HINIT", "KMAX", "MAXIT", "PATTERN", "ADAPTIVITY", "BETA", "GAMMA", "ALPHA")
OTHERS = ("CORRECTOR", "INTERPOLATE", "FIXIT", "HRATIO", "SCALE", "THREADS")
NAMED_FIRST = 2
"""Number of first lines that may answer the prompts of Adams/Solver for file names."""

CHANGED = {
    "PART": ("MASS", "IP"),
    "POINT_MASS": ("MASS",),
    "MARKER": ("QP", "REULER", "XP", "ZP", "USEXP"),
    "JOINT": ("I", "J", "PITCH", "PD"),
    "MOTION": ("FUNCTION", "DISPLACEMENT", "VELOCITY"),
}
"""Arguments that may be changed, by statement; of statements not listed here, all arguments may be changed."""


@dataclass(frozen=True)
class Segment:
    """Simulation, with the dataset changes made by the commands before it.

    `changes`: all changes so far. `settings`: run settings: ``rtol``, and ``max_step`` in the dataset's units.
    """

    simulation: Simulation
    changes: Changes
    settings: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Commands:
    """Content of a command file.

    `segments`: one for each simulation except those of initial conditions, from which every run starts. `changes`: all
    changes of the dataset. `notes`: one sentence for each ignored command.
    """

    segments: tuple[Segment, ...] = ()
    changes: Changes = field(default_factory=Changes)
    notes: tuple[str, ...] = ()


def read_commands(text: str, known: Collection[Key] = (), read: Read | None = None) -> Commands:
    """Read a command file for a dataset whose statements are `known` by name and number.

    `read`: returns the text of another command file by its name; without it FILE/COMMAND is refused. Raises
    DatasetFault if the file cannot be read, or contains an unsupported command that changes results.
    """
    segments: list[Segment] = []
    changes, settings = Changes(), dict[str, float]()
    left_out: list[str] = []
    linear: list[str] = []
    begun = False
    for command in all_commands(text, read):
        name = full_name(command.word)
        if name in ENDING:
            break
        if not begun and _is_name_of_file(command):
            continue
        begun = True
        if name == "SIMULATE":
            simulation = read_simulation(command)
            if simulation.kind != "INITIAL_CONDITIONS":
                segments.append(Segment(simulation, changes, dict(settings)))
        elif name == "INTEGRATOR":
            settings |= _integrator_settings(command)
            left_out.append(f"INTEGRATOR (line {command.line}) except HMAX, and ERROR below {DEFAULT_RTOL:g}")
        elif name == "LINEAR":
            linear.append(_linear_note(command, bool(segments)))
        elif name in SETTINGS:
            left_out.append(f"{name} (line {command.line})")
        elif name not in HARMLESS:
            if segments:
                _refuse_between_runs(command, name or "")
            changes = _followed(changes, command, name, known)
    notes = (f"{', '.join(left_out)} of the command file: left out, analysis settings",) if left_out else ()
    return Commands(tuple(segments), changes, (*linear, *notes))


def _linear_note(command: Statement, later: bool) -> str:
    """Return a note that LINEAR is ignored, with the equivalent command of this package."""
    found = Arguments(with_first_argument(command), "LINEAR", LINEAR)
    does = {
        "EIGENSOL": "'stiffmbs modes' computes eigenvalues and modes",
        "STATEMAT": "'stiffmbs response' computes frequency responses, and stiffmbs.transfer in Python the state matrices",
    }
    what = found.one_of(*does) or "EIGENSOL"
    where = " (with --from, of the state in which a run ends)" if later else ""
    return f"LINEAR/{what} (line {command.line} of the command file) is left out: {does[what]}{where}"


def full_name(word: str) -> str | None:
    """Return the full name of a command from an abbreviation of three letters or more; None if unknown."""
    names = (*FOLLOWED, *ENDING, *HARMLESS, *SETTINGS)
    if word in names:
        return word
    short = next((name for name in names if name.startswith(word)), None) if len(word) > 2 else None
    return short if short in (*FOLLOWED, *ENDING) else keyword(word) or short


def _is_name_of_file(command: Statement) -> bool:
    """Return True if a line before the first command names the model or the results: it has no slash and no argument."""
    return command.line <= NAMED_FIRST and not command.ident and all("=" not in piece.text for piece in command.pieces)


def _followed(changes: Changes, command: Statement, name: str | None, known: Collection[Key]) -> Changes:
    """Return the changes with those of a command added."""
    if name in ("ACTIVATE", "DEACTIVATE"):
        return changes.switched(command, name == "ACTIVATE", known)
    if alters(name):
        return changes.with_arguments(command)
    word, ident = key_of(command)
    raise DatasetFault(
        command.line,
        f"{word}/{ident or command.ident}".rstrip("/"),
        f"found an unsupported command, expected SIMULATE, ACTIVATE, DEACTIVATE, INTEGRATOR, STOP, new values of "
        f"statements, or one of {', '.join((*HARMLESS, *SETTINGS))}, which are left out",
    )


def _refuse_between_runs(command: Statement, name: str) -> None:
    """Refuse a change that would need other initial conditions or redefine the state carried over."""
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
                f"found {word} changed between two simulations, expected one of {', '.join(allowed)}: others define the "
                "start of the first",
            )


def _word(piece: Subsystem) -> str:
    """Return the argument named by a piece of a command; '' for a further value of the previous argument."""
    head = piece.text.partition("=")[0].strip().upper()
    return head if "=" in piece.text or head.isidentifier() else ""


def _integrator_settings(statement: Statement) -> dict[str, float]:
    """Return run settings: ``rtol`` if ERROR is below the default, ``max_step`` from HMAX in the dataset's units.

    The integration method and the formulation are ignored.
    """
    found = Arguments(statement, "INTEGRATOR", (*METHODS, *NUMBERS, *OTHERS))
    error, longest = found.positive("ERROR"), found.positive("HMAX")
    settings = {}
    if error is not None and error < DEFAULT_RTOL:  # a looser one, such as Adams' default 1e-3, does not change it
        settings["rtol"] = max(error, 1e-14)
    if longest is not None:
        settings["max_step"] = longest
    return settings
