"""Dataset changes by commands: arguments, activation and deactivation of statements."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from .arguments import Arguments
from .keywords import READERS, keyword
from .text import CommandFault, Statement

SWITCHED = (
    "JOINT", "JPRIM", "GCON", "MOTION", "COUPLER", "GEAR", "SFORCE", "VFORCE", "VTORQUE", "GFORCE", "SPRINGDAMPER",
    "BUSHING", "BEAM", "FIELD", "REQUEST", "CONTACT", "FRICTION", "NFORCE", "MFORCE", "PTCV", "CVCV", "SENSOR", "MREQUEST",
    "UCON", "GSE",
)  # fmt: skip
"""Statements that can be deactivated."""
GRAVITY: Final = ("ACCGRAV", 0)
Key = tuple[str, int]


@dataclass(frozen=True)
class Changes:
    """Changes of a dataset by commands."""

    # commands that change arguments of a statement, by its name and number
    altered: Mapping[Key, tuple[Statement, ...]] = field(default_factory=dict)
    inactive: Mapping[Key, int] = field(default_factory=dict)  # deactivated statements, and the line of the command

    def with_arguments(self, command: Statement) -> Changes:
        """Return the changes with new arguments of a statement."""
        key = key_of(command)
        return replace(self, altered={**self.altered, key: (*self.altered.get(key, ()), command)})

    def switched(self, command: Statement, active: bool, known: Collection[Key] = ()) -> Changes:
        """Return the changes after an ACTIVATE or DEACTIVATE command, by ID or by a RANGE of the `known` statements.

        Raises DatasetFault if the command names no statement, or one that cannot be deactivated.
        """
        found = Arguments(command, "ACTIVATE" if active else "DEACTIVATE", ("ID", "RANGE"))
        name = keyword(command.ident.upper())
        idents = found.idents("ID")
        if name not in SWITCHED or not (idents or "RANGE" in found):
            raise found.fault(
                f"found no statement, expected one of {', '.join(SWITCHED)} with ID = number or RANGE = first, last"
            )
        if "RANGE" in found:
            low, high = _ends(found)
            ranged = sorted(ident for kind, ident in known if kind == name and low <= ident <= high)
            if not ranged:
                raise found.fault(f"found no {name} from {low} to {high}, expected at least one", "RANGE")
            idents = (*idents, *ranged)
        inactive = dict(self.inactive)
        for ident in idents:
            inactive.pop((name, ident), None)
            if not active:
                inactive[name, ident] = command.line
        return replace(self, inactive=inactive)

    def applied(self, named: Sequence[tuple[str | None, Statement]]) -> list[tuple[str | None, Statement]]:
        """Return the statements of a dataset after the changes, without inactive ones.

        Raises DatasetFault if a changed statement does not exist.
        """
        known = {key_of(statement) for _, statement in named}
        for key, line in (*((key, c[0].line) for key, c in self.altered.items()), *self.inactive.items()):
            if key not in known and key != GRAVITY:
                label = f"{key[0]}/{key[1]}"
                raise CommandFault(
                    line, label, "found a command for a missing statement, expected a statement of the dataset"
                )
        found = [
            (name, self._changed(statement)) for name, statement in named if key_of(statement) not in self.inactive
        ]
        if GRAVITY in self.altered and GRAVITY not in known:
            line = self.altered[GRAVITY][0].line
            found.append(("ACCGRAV", self._changed(Statement("ACCGRAV", "", (), line))))
        return found

    def _changed(self, statement: Statement) -> Statement:
        commands = self.altered.get(key_of(statement), ())
        return replace(statement, changes=tuple((c.line, c.pieces) for c in commands)) if commands else statement

    def since(self, before: Changes) -> Changes:
        """Return the arguments changed and statements deactivated after earlier changes."""
        altered = {
            key: commands[len(before.altered.get(key, ())) :]
            for key, commands in self.altered.items()
            if len(commands) > len(before.altered.get(key, ()))
        }
        off = {key: line for key, line in self.inactive.items() if key not in before.inactive}
        return Changes(altered, off)

    def notes_since(self, before: Changes, source: str) -> list[str]:
        """Return one sentence for each change after earlier ones."""
        on = [f"{name}/{ident}" for name, ident in before.inactive if (name, ident) not in self.inactive]
        sentences = [f"{', '.join(on)} {'are' if len(on) > 1 else 'is'} activated again by {source}"] if on else []
        return [*self.since(before).notes(source), *sentences]

    def notes(self, source: str) -> list[str]:
        """Return one sentence for each kind of change."""
        sentences = []
        if self.inactive:
            labels = ", ".join(f"{name}/{ident}" for name, ident in self.inactive)
            sentences.append(
                f"{labels} {'are' if len(self.inactive) > 1 else 'is'} deactivated by {source} and left out"
            )
        if self.altered:
            labels = ", ".join(f"{name}/{ident}" if ident else name for name, ident in self.altered)
            sentences.append(f"{labels} {'are' if len(self.altered) > 1 else 'is'} changed by {source}")
        return sentences


def _ends(found: Arguments) -> tuple[int, int]:
    """Return the first and the last number of a RANGE; a single number is both."""
    ends = found.idents("RANGE", 1, 2)
    return ends[0], ends[-1]


def key_of(statement: Statement) -> Key:
    """Return a statement's full name and number, 0 without one."""
    ident = statement.ident.strip()
    return keyword(statement.word) or statement.word, int(ident) if ident.isdecimal() and len(ident) < 19 else 0


def alters(name: str | None) -> bool:
    """Return True if a command changes the arguments of a statement."""
    return name in READERS or name == "ACCGRAV"
